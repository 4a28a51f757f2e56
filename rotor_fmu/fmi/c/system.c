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

/* Whether a text begins with a URI's scheme, in capitals or not. */
static int is_uri(const char *text)
{
    static const char scheme[] = "file:";
    for (size_t i = 0; i < sizeof scheme - 1; i++)
        if (text[i] != scheme[i] && (text[i] | 32) != scheme[i])
            return 0;
    return 1;
}

/* Whether a path begins with a drive; a `|`, which old URIs have behind it, becomes a colon. */
static int is_drive(char *text)
{
    if (text[0] && text[1] == '|')
        text[1] = ':';
    return text[0] && text[1] == ':';
}

/* The path in what stands behind a URI's scheme, decoded. */
static char *path_in(char *at, int is_windows)
{
    if (!strncmp(at, "//", 2)) { /* an authority: none, localhost, or on Windows another machine */
        char *authority = at + 2, *rest = strchr(authority, '/');
        size_t length = rest ? (size_t)(rest - authority) : strlen(authority);
        int is_here = !length || (length == 9 && !strncmp(authority, "localhost", 9));
        if (is_windows && is_drive(authority))
            return authority;
        if (is_windows && !is_here)
            return at;
        at = authority + length;
    }
    return is_windows && at[0] == '/' && is_drive(at + 1) ? at + 1 : at;
}

/* The folder of a URI (FMI 2) or of a path (FMI 3), with the file's name behind it. */
static char *file_in(const char *resources)
{
#ifdef _WIN32
    enum { IS_WINDOWS = 1 };
#else
    enum { IS_WINDOWS = 0 };
#endif
    char *path = malloc(strlen(resources) + sizeof TABLE_FILE + 1), *to = path;
    if (!path)
        return NULL;
    if (!is_uri(resources)) {
        strcpy(path, resources);
    } else {
        for (const char *from = resources + 5; *from; from++) {
            int is_coded = *from == '%' && digit(from[1]) >= 0 && digit(from[2]) >= 0;
            *to++ = is_coded ? (char)(16 * digit(from[1]) + digit(from[2])) : *from;
            from += is_coded ? 2 : 0;
        }
        *to = 0;
        to = path_in(path, IS_WINDOWS);
        memmove(path, to, strlen(to) + 1);
    }
    to = path + strlen(path);
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

static const char OUT_OF_MEMORY[] = "out of memory";

Table *read_table(const char *resources, char *why, size_t room)
{
    char *path = resources ? file_in(resources) : NULL;
    FILE *file = path ? opened(path) : NULL;
    Table *table = NULL;
    const char *fault = resources && !path ? OUT_OF_MEMORY : "cannot be read";
    /* a folder can be opened, and has a size */
    int is_file = file && fgetc(file) != EOF && !fseek(file, 0, SEEK_END);
    long size = is_file ? ftell(file) : 0;
    if (size > 0) {
        rewind(file);
        table = malloc((size_t)size);
        size_t got = table ? fread(table, 1, (size_t)size, file) : 0;
        if (!table)
            fault = OUT_OF_MEMORY;
        else if (got == (size_t)size)
            fault = check_table(table, got);
    }
    if (file)
        fclose(file);
    if (fault) {
        snprintf(why, room, "%.600s: %s", path ? path : "the location of the resources", fault);
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
