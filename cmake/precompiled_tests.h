// As precompiled.h, with what every test sees besides.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cmake/precompiled.h"
