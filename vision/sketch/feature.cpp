#include "vision/sketch/feature.h"
