#include "planning/robot/robot_model.h"
