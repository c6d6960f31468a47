#include "hardware/device.h"
