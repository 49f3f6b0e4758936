/* The functions that newlib calls. */
#include <errno.h>
#include <sys/stat.h>
#include <sys/types.h>

extern int __io_putchar(int ch);
extern char end;
extern char _estack;
extern char _Min_Stack_Size;

int _write(int file, const char *data, int length)
{
    (void)file;
    for (int index = 0; index < length; index++) {
        (void)__io_putchar(data[index]);
    }
    return length;
}

void *_sbrk(ptrdiff_t increment)
{
    static char *top = &end;
    char *const limit = &_estack - (size_t)&_Min_Stack_Size;
    if (increment > limit - top) {
        errno = ENOMEM;
        return (void *)-1;
    }
    char *const block = top;
    top += increment;
    return block;
}

int _close(int file)
{
    (void)file;
    return -1;
}

int _fstat(int file, struct stat *status)
{
    (void)file;
    status->st_mode = S_IFCHR;
    return 0;
}

int _isatty(int file)
{
    (void)file;
    return 1;
}

off_t _lseek(int file, off_t offset, int whence)
{
    (void)file;
    (void)offset;
    (void)whence;
    return 0;
}

int _read(int file, char *data, int length)
{
    (void)file;
    (void)data;
    (void)length;
    return 0;
}

int _getpid(void)
{
    return 1;
}

int _kill(int process, int signal)
{
    (void)process;
    (void)signal;
    errno = EINVAL;
    return -1;
}

void _exit(int status)
{
    (void)status;
    while (1) {
    }
}
