/* Counts the calls of fsync and fdatasync of a process and its children, and makes each last longer.
 *
 * LIVELLA_FSYNC_COUNT  file of 8 bytes, the count
 * LIVELLA_FSYNC_MS     ms each call lasts longer
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

static long *count;
static double delay;

__attribute__((constructor)) static void open_count(void) {
    const char *path = getenv("LIVELLA_FSYNC_COUNT"), *ms = getenv("LIVELLA_FSYNC_MS");
    int file = path ? open(path, O_RDWR) : -1;
    delay = ms ? atof(ms) : 0.0;
    if (file < 0)
        return;
    count = mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (count == MAP_FAILED)
        count = NULL;
    close(file);
}

static int sync_by(const char *name, int file) {
    int (*real)(int) = (int (*)(int))dlsym(RTLD_NEXT, name);
    struct timespec pause = {(time_t)(delay / 1e3), (long)((delay - 1e3 * (time_t)(delay / 1e3)) * 1e6)};
    if (count)
        __atomic_add_fetch(count, 1, __ATOMIC_RELAXED);
    if (delay > 0.0)
        nanosleep(&pause, NULL);
    return real(file);
}

int fsync(int file) { return sync_by("fsync", file); }
int fdatasync(int file) { return sync_by("fdatasync", file); }
