#pragma once
// What a run uses of the machine: time, memory; and the guard that ends it when it takes more than allowed.
#include <atomic>
#include <cstdint>
#include <thread>

namespace periost {

int core_count();                      // cores that this process may use
std::uint64_t machine_memory_bytes();  // physical memory
double cpu_seconds();                  // of this process and of its children that have ended
std::uint64_t resident_bytes();        // of this process, now
std::uint64_t peak_resident_bytes();   // of this process since reset_peak_resident(), or since it began
std::uint64_t children_peak_bytes();   // the largest of all children that have ended
void reset_peak_resident();  // where the kernel allows it; else the peak keeps counting from the start

// Polls the resident memory every 20 ms and sets `cancel` once it passes `limit_bytes` (0: never), so that
// the running stage stops at its next poll of the context. `cancel` must outlive the guard.
class MemoryGuard {
 public:
  MemoryGuard(std::uint64_t limit_bytes, std::atomic<bool>& cancel);
  ~MemoryGuard();
  MemoryGuard(const MemoryGuard&) = delete;
  MemoryGuard& operator=(const MemoryGuard&) = delete;

  // The resident memory that passed the limit, or 0.
  std::uint64_t exceeded_bytes() const { return exceeded_.load(); }

 private:
  std::atomic<std::uint64_t> exceeded_{0};
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace periost
