/* What a page calls, in a browser: an instance of a table in memory, whose messages go to a function
   of the page; the rest of its life is FMI 2.0's functions. */
#ifdef __wasm__
#include "instance.h"

__attribute__((import_module("page"), import_name("log_message")))
void log_message(void *environment, int status, const char *message);
Instance *rotor_instantiate(const char *name, const void *table, size_t size,
                            void (*receiver)(void *, int, const char *), void *environment);

EXPORT Instance *page_instantiate(const void *table, size_t size)
{
    return rotor_instantiate("rotor", table, size, log_message, NULL);
}
#endif
