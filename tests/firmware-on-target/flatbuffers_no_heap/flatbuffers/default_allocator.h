#pragma once
#include "flatbuffers/allocator.h"

// In the place of FlatBuffers' own header of this name, whose default allocator is the heap: here every builder has to
// bring an allocator.

namespace flatbuffers {

class DefaultAllocator : public Allocator {
 public:
  uint8_t* allocate(size_t) override { abort(); }
  void deallocate(uint8_t*, size_t) override { abort(); }
  static void dealloc(void*, size_t) { abort(); }
};

inline uint8_t* Allocate(Allocator* allocator, size_t size) {
  return allocator->allocate(size);
}

inline void Deallocate(Allocator* allocator, uint8_t* p, size_t size) {
  allocator->deallocate(p, size);
}

inline uint8_t* ReallocateDownward(Allocator* allocator, uint8_t* old_p, size_t old_size, size_t new_size,
                                   size_t in_use_back, size_t in_use_front) {
  return allocator->reallocate_downward(old_p, old_size, new_size, in_use_back, in_use_front);
}

}  // namespace flatbuffers
