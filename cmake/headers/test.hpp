#pragma once

// Headers that most tests include, compiled once.
#include "cmake/headers/io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include <csignal>
#include <future>
#include <sstream>
#include <stdexcept>
