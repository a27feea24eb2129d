#ifndef FASCICLE_SERVER_JOBS_CRASH_MARKS_H_
#define FASCICLE_SERVER_JOBS_CRASH_MARKS_H_

#include <string>
#include <vector>

namespace fascicle::server {

// Which jobs crashed the process, as a file with one job id in each line. The next process reads it, so that a job that
// crashes the server again and again can be ended.

// Makes a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) of a thread that is marked by JobOnThisThread append its job
// to the file. The process then dies of the signal as usual. For the whole process.
void RecordCrashes(const std::string& path);

// The jobs of the file, which is emptied; none if it can't be read.
std::vector<std::string> TakeCrashes(const std::string& path);

// Marks the calling thread as working for a job, until it is destroyed.
class JobOnThisThread {
 public:
  explicit JobOnThisThread(const std::string& id);
  ~JobOnThisThread();
  JobOnThisThread(const JobOnThisThread&) = delete;
  JobOnThisThread& operator=(const JobOnThisThread&) = delete;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_CRASH_MARKS_H_
