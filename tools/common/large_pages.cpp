// Takes blocks of 2 MiB or more from the system in large pages, in all programs that link this:
// models, scenes and packings are touched for the first time with fewer faults, and read with fewer
// misses of the address cache. Without it making a model of 40 spheres takes 1.4 times as long, and
// 1500 poses before a recorded kitchen 1.2 times. Sanitizers bring an allocator of their own, so it
// is not built with them.
//
// Keeps what was freed for the next blocks instead of handing it back to the system, which would
// clear it before it gives it again: packing a mesh of 86 000 triangles then takes half the faults.
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;  // bytes

// Asks for large pages wherever a block has a part of one, and for the heap after it: malloc()
// writes behind a block, and what is touched before it is asked for keeps small pages. A kernel
// that has no large ones says so, and nothing changes.
void ask_for_large_pages(void* block, std::size_t size) {
  const auto address = reinterpret_cast<std::uintptr_t>(block),
             heap_end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  const std::uintptr_t first = address / kLargePage * kLargePage,
                       last = address < heap_end ? heap_end : address + size,
                       end = (last + kLargePage - 1) / kLargePage * kLargePage;
  madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

#ifdef M_TRIM_THRESHOLD
// Both are what glibc comes to by itself for programs that free such blocks: its largest block that
// is not mapped on its own, and twice as much free memory.
constexpr int kLargestKept = 32 << 20, kKept = 2 * kLargestKept;  // bytes

// Sets these two, and lets the heap grow by as much as the former. Asks for large pages in the
// first part of it, from which most blocks come.
[[maybe_unused]] const bool keeps_memory = [] {
  const bool is_set = mallopt(M_MMAP_THRESHOLD, kLargestKept) != 0 &&
                      mallopt(M_TRIM_THRESHOLD, kKept) != 0 &&
                      mallopt(M_TOP_PAD, kLargestKept) != 0;
  void* const block = std::malloc(kLargePage);
  if (block != nullptr) ask_for_large_pages(block, kLargePage);
  std::free(block);
  return is_set;
}();
#endif

}  // namespace

// Stands for the standard library's, whose `operator delete` frees what malloc() gave.
void* operator new(std::size_t size) {
  while (true) {
    if (void* block = std::malloc(size > 0 ? size : 1)) {
      if (size >= kLargePage) ask_for_large_pages(block, size);
      return block;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
