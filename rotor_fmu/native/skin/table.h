#ifndef ROTOR_TABLE_H
#define ROTOR_TABLE_H
#include "instance.h"

/* The table in the folder of an FMU's resources, to be freed; NULL with the reason in `why`. */
Table *read_table(const char *resources, char *why, size_t room);
#endif
