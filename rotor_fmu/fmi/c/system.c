/* What an instance asks of its system: the table of the machine, read from the FMU's resources, and
   standard error. `c_component/` has another for a component, which asks for nothing. */
#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#define NOGDI /* it calls a number ERROR */
#include <windows.h>
#endif

static int digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c |= 32;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The folder of a URI (FMI 2) or of a path (FMI 3), with the file's name behind it. */
static char *file_in(const char *resources)
{
    const char *from = resources;
    int is_uri = !strncmp(from, "file:", 5);
    char *path = malloc(strlen(resources) + sizeof TABLE_FILE + 1), *to = path;
    if (!path)
        return NULL;
    if (is_uri) {
        from += 5;
        if (!strncmp(from, "//", 2)) /* an authority, empty or localhost */
            from = strchr(from + 2, '/') ? strchr(from + 2, '/') : from + 2;
#ifdef _WIN32
        if (from[0] == '/' && from[1] && (from[2] == ':' || from[2] == '|'))
            from++;
#endif
    }
    for (; *from; from++) {
        if (is_uri && *from == '%' && digit(from[1]) >= 0 && digit(from[2]) >= 0) {
            *to++ = (char)(16 * digit(from[1]) + digit(from[2]));
            from += 2;
        } else {
            *to++ = *from;
        }
    }
    if (to > path && to[-1] != '/' && to[-1] != '\\')
        *to++ = '/';
    strcpy(to, TABLE_FILE);
    return path;
}

static FILE *opened(const char *path)
{
#ifdef _WIN32
    wchar_t wide[4096];
    if (!MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096))
        return NULL;
    return _wfopen(wide, L"rb");
#else
    return fopen(path, "rb");
#endif
}

Table *read_table(const char *resources, char *why, size_t room)
{
    char *path = resources ? file_in(resources) : NULL;
    FILE *file = path ? opened(path) : NULL;
    Table *table = NULL;
    const char *fault = "cannot be read";
    if (file && !fseek(file, 0, SEEK_END)) {
        long size = ftell(file);
        if (size > 0 && (table = malloc((size_t)size)) != NULL) {
            rewind(file);
            size_t got = fread(table, 1, (size_t)size, file);
            fault = got == (size_t)size ? check_table(table, got) : "cannot be read";
        }
    }
    if (file)
        fclose(file);
    if (fault) {
        snprintf(why, room, "%s: %s", path ? path : "the location of the resources", fault);
        free(table);
        table = NULL;
    }
    free(path);
    return table;
}

void write_error(const char *name, const char *level, const char *message)
{
    fprintf(stderr, "%s: %s: %s\n", name, level, message);
    fflush(stderr);
}
