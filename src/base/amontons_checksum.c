/* Fletcher's checksum of 32-bit words (the low byte first, as the machine has it; zeros fill the last one), with two
   sums of 64 bits: of the words, and of these sums. No change of one word or of two leaves both as they were, and it
   is nearly as fast as memory. */
#define _XOPEN_SOURCE 700

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct sums {
    uint64_t words, sums;
};

/* Adds bytes, a multiple of 4 of them unless they are the last. */
static struct sums add_bytes(struct sums total, const unsigned char *bytes, size_t n_bytes)
{
    uint64_t words = total.words, sums = total.sums;
    uint32_t word;
    for (; n_bytes >= sizeof word; bytes += sizeof word, n_bytes -= sizeof word) {
        memcpy(&word, bytes, sizeof word);
        words += word;
        sums += words;
    }
    if (n_bytes > 0) {
        word = 0;
        memcpy(&word, bytes, n_bytes);
        words += word;
        sums += words;
    }
    return (struct sums){words, sums};
}

/* Writes the sums as 32 hexadecimal digits; the text has room for the zero behind them. */
static void write_digits(struct sums total, char *digits)
{
    snprintf(digits, 33, "%016" PRIx64 "%016" PRIx64, total.words, total.sums);
}

/* The checksum of a text. */
void amontons_checksum_of_text(const char *text, long n_bytes, char *digits)
{
    write_digits(add_bytes((struct sums){0, 0}, (const unsigned char *)text, (size_t)n_bytes), digits);
}

/* Fills a buffer from a file as far as the file goes. Returns how many bytes, or minus the system's error number. */
static long fill(int file, unsigned char *buffer, size_t size)
{
    size_t n_read = 0;
    while (n_read < size) {
        ssize_t n = read(file, buffer + n_read, size - n_read);
        if (n == 0)
            break;
        if (n > 0)
            n_read += (size_t)n;
        else if (errno != EINTR)
            return -errno;
    }
    return (long)n_read;
}

/* The checksum of a file and its size. Returns 0 or the system's error number. What a pipe held is gone when it has
   been read: it has no checksum. */
int amontons_checksum_of_file(const char *path, char *digits, long long *n_bytes)
{
    enum { size = 1 << 17 };
    int file = open(path, O_RDONLY | O_NONBLOCK);
    if (file < 0)
        return errno;
    struct stat status;
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(file);
        return EINVAL;
    }
    unsigned char *buffer = malloc(size);
    long n = buffer ? size : -ENOMEM;
    struct sums total = {0, 0};
    *n_bytes = 0;
    while (n == size) {
        n = fill(file, buffer, size);
        if (n > 0) {
            total = add_bytes(total, buffer, (size_t)n);
            *n_bytes += n;
        }
    }
    free(buffer);
    close(file);
    write_digits(total, digits);
    return n < 0 ? (int)-n : 0;
}
