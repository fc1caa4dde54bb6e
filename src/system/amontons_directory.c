/* The names that a directory holds. */
#define _XOPEN_SOURCE 700

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Finds the names in a directory, in the order of their bytes, each ended by a zero, one behind the other. Returns 0 or
   the system's error number. The caller takes the names with amontons_take_names. */
int amontons_list_directory(const char *path, char **names, int *n_names, long *length)
{
    struct dirent **entries;
    int n = scandir(path, &entries, NULL, alphasort);
    if (n < 0)
        return errno;
    size_t size = 0;
    for (int i = 0; i < n; i++)
        size += strlen(entries[i]->d_name) + 1;
    char *place = *names = malloc(size + 1);
    for (int i = 0; i < n; i++) {
        if (place) {
            strcpy(place, entries[i]->d_name);
            place += strlen(place) + 1;
        }
        free(entries[i]);
    }
    free(entries);
    *n_names = n;
    *length = (long)size;
    return *names ? 0 : ENOMEM;
}

/* Copies the names and gives their memory up. */
void amontons_take_names(char *names, char *text, long length)
{
    memcpy(text, names, (size_t)length);
    free(names);
}
