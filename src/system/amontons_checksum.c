/* The checksum of POSIX, which `cksum` prints: the remainder of the bytes and of their number, lowest byte first, as a
   polynomial modulo x^32 + x^26 + x^23 + x^22 + x^16 + x^12 + x^11 + x^10 + x^8 + x^7 + x^5 + x^4 + x^2 + x + 1, with
   every bit reversed at the end. Sixteen bytes are taken at once, each with a table of its own: only four of them
   wait for the remainder of those before. */
#define _XOPEN_SOURCE 700

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { n_at_once = 16 };

static const uint32_t polynomial = 0x04c11db7;
static pthread_once_t is_filled = PTHREAD_ONCE_INIT;
/* What a byte with so many bytes behind it adds to the remainder. */
static uint32_t tables[n_at_once][256];

static void fill_tables(void)
{
    for (uint32_t byte = 0; byte < 256; byte++) {
        uint32_t remainder = byte << 24;
        for (int bit = 0; bit < 8; bit++)
            remainder = remainder & 0x80000000u ? remainder << 1 ^ polynomial : remainder << 1;
        tables[0][byte] = remainder;
    }
    for (int behind = 1; behind < n_at_once; behind++)
        for (int byte = 0; byte < 256; byte++) {
            uint32_t before = tables[behind - 1][byte];
            tables[behind][byte] = before << 8 ^ tables[0][before >> 24];
        }
}

static uint32_t with_byte(uint32_t remainder, unsigned char byte)
{
    return remainder << 8 ^ tables[0][remainder >> 24 ^ byte];
}

/* Adds bytes to the remainder of those before them. */
void amontons_add_to_checksum(uint32_t *remainder, const char *bytes, int64_t n_bytes)
{
    pthread_once(&is_filled, fill_tables);
    const unsigned char *b = (const unsigned char *)bytes;
    uint32_t r = *remainder;
    for (; n_bytes >= n_at_once; b += n_at_once, n_bytes -= n_at_once) {
        uint32_t next = 0;
        for (int i = 4; i < n_at_once; i++)
            next ^= tables[n_at_once - 1 - i][b[i]];
        r = next ^ tables[15][b[0] ^ r >> 24] ^ tables[14][b[1] ^ (r >> 16 & 255)] ^ tables[13][b[2] ^ (r >> 8 & 255)]
            ^ tables[12][b[3] ^ (r & 255)];
    }
    for (; n_bytes > 0; n_bytes--)
        r = with_byte(r, *b++);
    *remainder = r;
}

/* The checksum of so many bytes with this remainder. */
int64_t amontons_checksum_value(uint32_t remainder, int64_t n_bytes)
{
    pthread_once(&is_filled, fill_tables);
    for (; n_bytes > 0; n_bytes >>= 8)
        remainder = with_byte(remainder, (unsigned char)(n_bytes & 255));
    return (int64_t)(uint32_t)~remainder;
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
int amontons_checksum_of_file(const char *path, int64_t most, uint32_t *remainder, int64_t *n_bytes)
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
            amontons_add_to_checksum(remainder, buffer, n);
            *n_bytes += n;
        }
    }
    free(buffer);
    close(file);
    return n < 0 ? (int)-n : 0;
}
