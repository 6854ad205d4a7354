/* Preloaded: memory that a program frees is not given out again, and whoever still looks at it is found
 * out: it holds what a shared pointer takes for its last reference, to an object without functions. */

#include <malloc.h>
#include <string.h>

void free(void *memory)
{
    const int one = 1;
    if (memory && malloc_usable_size(memory) >= 16) {
        memset(memory, 0, 8);
        memcpy((char *)memory + 8, &one, sizeof one);
    }
}
