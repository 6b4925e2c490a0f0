/* A disk that fails, for tests: preloaded with LD_PRELOAD, the n-th call of a kind that is about a file below a folder
   gets an error of the operating system. The file is closed all the same where `close` fails, as on Linux. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *folder, *kind;
static int reason, left;

void fail_disk(const char *where, const char *call, int error, int number) {
    folder = strdup(where), kind = strdup(call), reason = error, left = number;
}

int has_failed(void) { return left <= 0; }

static int fails(const char *call, int at, const char *path) {
    char link[64], found[PATH_MAX + 1], whole[2 * PATH_MAX + 2];
    if (!kind || left <= 0 || strcmp(kind, call)) return 0;
    if (!path || path[0] != '/') {
        if (at == AT_FDCWD) strcpy(link, "/proc/self/cwd");
        else snprintf(link, sizeof link, "/proc/self/fd/%d", at);
        ssize_t length = readlink(link, found, PATH_MAX);
        if (length < 0) return 0;
        found[length] = 0;
        snprintf(whole, sizeof whole, "%s%s%s", found, path ? "/" : "", path ? path : "");
        path = whole;
    }
    if (strncmp(path, folder, strlen(folder)) || --left) return 0;
    errno = reason;
    return 1;
}

#define REAL(result, name, parameters) \
    static result(*real) parameters; \
    if (!real) real = dlsym(RTLD_NEXT, name)
#define CALL(result, name, call, parameters, arguments, at, path) \
    result name parameters { REAL(result, #name, parameters); return fails(call, at, path) ? -1 : real arguments; }
#define OPEN(name) \
    int name(const char *path, int flags, ...) { \
        REAL(int, #name, (const char *, int, ...)); \
        va_list more; va_start(more, flags); int mode = va_arg(more, int); va_end(more); \
        return fails("open", AT_FDCWD, path) ? -1 : real(path, flags, mode); }
#define OPENAT(name) \
    int name(int at, const char *path, int flags, ...) { \
        REAL(int, #name, (int, const char *, int, ...)); \
        va_list more; va_start(more, flags); int mode = va_arg(more, int); va_end(more); \
        return fails("open", at, path) ? -1 : real(at, path, flags, mode); }

OPEN(open) OPEN(open64) OPENAT(openat) OPENAT(openat64)
CALL(ssize_t, read, "read", (int file, void *to, size_t size), (file, to, size), file, 0)
CALL(ssize_t, write, "write", (int file, const void *from, size_t size), (file, from, size), file, 0)
CALL(int, fsync, "fsync", (int file), (file), file, 0)
CALL(int, rename, "rename", (const char *from, const char *to), (from, to), AT_FDCWD, to)
CALL(int, unlink, "unlink", (const char *path), (path), AT_FDCWD, path)
CALL(int, unlinkat, "unlink", (int at, const char *path, int flags), (at, path, flags), at, path)
CALL(int, mkdir, "mkdir", (const char *path, mode_t mode), (path, mode), AT_FDCWD, path)
CALL(int, rmdir, "rmdir", (const char *path), (path), AT_FDCWD, path)

int close(int file) {
    REAL(int, "close", (int));
    if (!fails("close", file, 0)) return real(file);
    real(file);
    errno = reason;
    return -1;
}
