#include "libvpm/query/cuda/launch.h"
#include "tests/cuda/waiting.h"

namespace vpm::testing {
namespace {

__global__ void wait_until(const volatile unsigned* go) {
  while (*go == 0) {
  }
}

}  // namespace

Asked ask_while_a_kernel_waits() {
  using namespace cuda;
  const Stream stream;
  const Event behind;
  const MappedArray<unsigned> go(1);
  wait_until<<<1, 1, 0, stream.get()>>>(go.device());
  check(cudaGetLastError());
  check(cudaEventRecord(behind.get(), stream.get()));
  Asked asked;
  asked.was_done = has_happened(behind);
  asked.left_error = cudaGetLastError() != cudaSuccess;
  *static_cast<volatile unsigned*>(go.host()) = 1;
  check(cudaStreamSynchronize(stream.get()));
  asked.is_done_now = has_happened(behind);
  return asked;
}

}  // namespace vpm::testing
