// SPDX-License-Identifier: Apache-2.0
#include "io/threads.h"

#include <ImfThreading.h>

#include <atomic>
#include <cstdlib>

namespace ssdo {
namespace {

std::atomic<int> most_threads = 0;

}  // namespace

void limit_io_threads(int count) {
  most_threads = count;
  // OpenEXR counts helpers beside the calling thread: 0 makes it work alone.
  OPENEXR_IMF_NAMESPACE::setGlobalThreadCount(count == 1 ? 0 : count);
  // OpenImageIO starts $CUE_THREADS threads, be they 99999, before another number can be set, and
  // waits for ever where the second of them does not start.
  setenv("OPENIMAGEIO_THREADS", "1", 1);
  // OpenImageIO brings OpenCV and so BLAS, of which nothing is used here. Where that is OpenBLAS, it
  // starts a thread for each core, and at the end waits for ever for one that gets no memory.
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
}

int io_threads() { return most_threads; }

}  // namespace ssdo
