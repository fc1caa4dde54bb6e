/* Fletcher's checksum of 32-bit words (the low byte first, as the machine has it; zeros fill the last one), with two
   sums of 64 bits: of the words, and of these sums. No change of one word or of two leaves both as they were, and it
   is nearly as fast as memory. */
#define _XOPEN_SOURCE 700

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { word_size = 4 };

/* Adds bytes to the checksum of those before them. The last word counts with zeros for the bytes that it lacks: what
   comes in their place is added to both sums. */
void amontons_add_to_checksum(uint64_t total[2], int64_t n_before, const char *bytes, int64_t n_bytes)
{
    uint64_t words = total[0], sums = total[1];
    uint32_t word;
    for (int place = (int)(n_before % word_size); place % word_size != 0 && n_bytes > 0; place++, n_bytes--) {
        uint64_t more = (uint64_t)(unsigned char)*bytes++ << 8 * place;
        words += more;
        sums += more;
    }
    for (; n_bytes >= word_size; bytes += word_size, n_bytes -= word_size) {
        memcpy(&word, bytes, word_size);
        words += word;
        sums += words;
    }
    if (n_bytes > 0) {
        word = 0;
        memcpy(&word, bytes, (size_t)n_bytes);
        words += word;
        sums += words;
    }
    total[0] = words;
    total[1] = sums;
}

/* Fills a buffer from a file as far as the file goes. Returns how many bytes, or minus the system's error number. */
static int64_t fill(int file, char *buffer, int64_t size)
{
    int64_t n_read = 0;
    while (n_read < size) {
        ssize_t n = read(file, buffer + n_read, (size_t)(size - n_read));
        if (n == 0)
            break;
        if (n > 0)
            n_read += n;
        else if (errno != EINTR)
            return -errno;
    }
    return n_read;
}

/* Adds a file, or its first bytes if it has more than so many. Returns 0 or the system's error number. What a pipe held
   is gone when it has been read: it has no checksum. */
int amontons_checksum_of_file(const char *path, int64_t most, uint64_t total[2], int64_t *n_bytes)
{
    const int64_t size = 1 << 17;
    int file = open(path, O_RDONLY | O_NONBLOCK);
    if (file < 0)
        return errno;
    struct stat status;
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(file);
        return EINVAL;
    }
    char *buffer = malloc((size_t)size);
    int64_t n = buffer ? size : -ENOMEM;
    while (n == size) {
        n = fill(file, buffer, most - *n_bytes < size ? most - *n_bytes : size);
        if (n > 0) {
            amontons_add_to_checksum(total, *n_bytes, buffer, n);
            *n_bytes += n;
        }
    }
    free(buffer);
    close(file);
    return n < 0 ? (int)-n : 0;
}
