// query-time: how long the public library takes for poses, beside which scripts/python_cost.py
// times the same poses in Python.
//
//   query-time TOOL.vpmg CLOUD.vpmc POSES      POSES has a pose on each line
//
// A line "batch" of standard input asks all poses together, any other line asks them one by one, on
// one thread. For each line it prints the seconds of the processor that this took, and the sum of
// the volumes, in m^3.
#include <vpm/device.h>
#include <vpm/query.h>

#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

std::vector<vpm::Job> jobs_in(const char* path) {
  std::vector<vpm::Job> jobs;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) jobs.push_back({vpm::pose_from_text(line)});
  return jobs;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fputs("usage: query-time TOOL.vpmg CLOUD.vpmc POSES\n", stderr);
    return 2;
  }
  vpm::set_thread_count(1);
  const vpm::Scene scene(vpm::PointCloud::read(argv[2]));
  vpm::Query query(vpm::Tool::read(argv[1]));
  const std::vector<vpm::Job> jobs = jobs_in(argv[3]);
  std::vector<vpm::Result> results(jobs.size());
  for (std::string asked; std::getline(std::cin, asked);) {
    const std::clock_t start = std::clock();
    if (asked == "batch") {
      query.run(scene, jobs, results);
    } else {
      for (std::size_t k = 0; k < jobs.size(); ++k) results[k] = query.run(scene, jobs[k].pose);
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    double volume = 0;
    for (const vpm::Result& result : results) volume += result.volume;
    std::printf("%.9g %.17g\n", seconds, volume);
    std::fflush(stdout);
  }
  return 0;
} catch (const vpm::Error& error) {
  std::fprintf(stderr, "query-time: %s\n", error.what());
  return 1;
}
