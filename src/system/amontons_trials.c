/* What may end the process, tried in another one first. */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

enum { seconds = 60 };

/* Whether a procedure comes to its end in a copy of this process, in which it may crash or hang without harm. Where no
   copy can be made or watched it is taken to do so. */
int amontons_ends_well(void (*procedure)(const char *), const char *argument)
{
    pid_t child = fork();
    if (child < 0)
        return 1;
    if (child == 0) {
        struct sigaction action = {0};
        action.sa_handler = SIG_DFL;
        for (int number = 1; number <= SIGRTMAX; number++)
            sigaction(number, &action, NULL);
        int nowhere = open("/dev/null", O_WRONLY);
        dup2(nowhere, STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
        alarm(seconds);
        procedure(argument);
        _exit(0);
    }
    int status = 0;
    pid_t ended;
    do
        ended = waitpid(child, &status, 0);
    while (ended < 0 && errno == EINTR);
    return ended != child || (WIFEXITED(status) && WEXITSTATUS(status) == 0);
}
