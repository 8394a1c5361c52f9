// Functions of Linux that emscripten's C library lacks. ../posix uses them for what is optional, so they may fail.

#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>

extern "C" {

int pthread_setaffinity_np(pthread_t /*thread*/, size_t /*size*/, const cpu_set_t* /*cpus*/) {
  return ENOSYS;
}

int pthread_getaffinity_np(pthread_t /*thread*/, size_t /*size*/, cpu_set_t* /*cpus*/) {
  return ENOSYS;
}

int __sched_cpucount(size_t /*size*/, const cpu_set_t* /*cpus*/) {  // NOLINT: the C library's name, behind CPU_COUNT
  return 1;
}

int pthread_getschedparam(pthread_t /*thread*/, int* /*policy*/, sched_param* /*parameters*/) {
  return ENOSYS;
}

int pthread_setschedparam(pthread_t /*thread*/, int /*policy*/, const sched_param* /*parameters*/) {
  return ENOSYS;
}

int prctl(int /*option*/, ...) {
  errno = ENOSYS;
  return -1;
}

int sigaltstack(const stack_t* __restrict /*stack*/, stack_t* __restrict /*before*/) {
  errno = ENOSYS;
  return -1;
}

ssize_t getrandom(void* bytes, size_t size, unsigned /*flags*/) {
  return getentropy(bytes, size) == 0 ? static_cast<ssize_t>(size) : -1;
}

}  // extern "C"
