/* Made by CMake: the version stands in CMakeLists.txt alone. */
#ifndef HAPTOLITH_VERSION_H
#define HAPTOLITH_VERSION_H

#define HAPTO_VERSION_MAJOR 0
#define HAPTO_VERSION_MINOR 2
#define HAPTO_VERSION_PATCH 0
#define HAPTO_VERSION_STRING "0.2.0"
/* 1000000 * major + 1000 * minor + patch */
#define HAPTO_VERSION (1000000 * HAPTO_VERSION_MAJOR + 1000 * HAPTO_VERSION_MINOR + HAPTO_VERSION_PATCH)

#endif
