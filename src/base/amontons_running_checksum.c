/* Sums that tell whether bytes are still the same: Fowler, Noll and Vo's hash 1a of 64 bits. */
#include <errno.h>
#include <stdint.h>
#include <stdio.h>

/* The sum of bytes behind those of an earlier sum; 0 for none. */
int64_t amontons_add_to_checksum(int64_t before, const char *bytes, long n_bytes)
{
    uint64_t sum = (uint64_t)before ^ UINT64_C(14695981039346656037);
    for (long i = 0; i < n_bytes; i++)
        sum = (sum ^ (unsigned char)bytes[i]) * UINT64_C(1099511628211);
    return (int64_t)(sum ^ UINT64_C(14695981039346656037));
}

/* The sum of the first bytes of a file. Returns 0, or the system's error number where there are not so many. */
int amontons_checksum_of_start(const char *path, long long n_bytes, int64_t *sum)
{
    static const size_t size = 65536;
    char bytes[65536];
    FILE *file = fopen(path, "rb");
    if (!file)
        return errno;
    *sum = 0;
    while (n_bytes > 0) {
        size_t n = fread(bytes, 1, n_bytes < (long long)size ? (size_t)n_bytes : size, file);
        if (n == 0)
            break;
        *sum = amontons_add_to_checksum(*sum, bytes, (long)n);
        n_bytes -= (long long)n;
    }
    fclose(file);
    return n_bytes == 0 ? 0 : EIO;
}
