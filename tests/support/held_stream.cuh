// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// CUDA streams for tests, and a gate that holds them.

#include <clearance/backends/cuda_error.cuh>

#include <atomic>
#include <chrono>
#include <thread>

namespace testing {

inline void check(cudaError_t status) { clearance::check_cuda(status, "a call of the test"); }

/// A new stream on the current device.
struct own_stream {
  cudaStream_t handle = nullptr;
  own_stream() { check(cudaStreamCreateWithFlags(&handle, cudaStreamNonBlocking)); }
  ~own_stream() { cudaStreamDestroy(handle); }
  own_stream(const own_stream&) = delete;
};

/// What `enqueue` puts into a stream, captured as a graph.
class captured_graph {
 public:
  template <class F>
  captured_graph(cudaStream_t stream, const F& enqueue) : stream_(stream) {
    check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    try {
      enqueue();
    } catch (...) {
      cudaStreamEndCapture(stream, &graph_), cudaGraphDestroy(graph_), cudaGetLastError();
      throw;
    }
    check(cudaStreamEndCapture(stream, &graph_));
    check(cudaGraphInstantiate(&ready_, graph_, 0));
  }
  ~captured_graph() { cudaGraphExecDestroy(ready_), cudaGraphDestroy(graph_); }
  captured_graph(const captured_graph&) = delete;

  void launch() const { check(cudaGraphLaunch(ready_, stream_)); }

 private:
  cudaStream_t stream_;
  cudaGraph_t graph_ = nullptr;
  cudaGraphExec_t ready_ = nullptr;
};

/// Holds a stream until it is released, at the latest by the destructor. Kernels must have run once before, because
/// loading one may wait for everything.
class gate {
 public:
  explicit gate(cudaStream_t stream) : stream_(stream) {
    check(cudaLaunchHostFunc(
        stream,
        [](void* open) {
          while (!*static_cast<std::atomic<bool>*>(open)) std::this_thread::sleep_for(std::chrono::microseconds(50));
        },
        &open_));
  }
  void release() {
    open_ = true;
    check(cudaStreamSynchronize(stream_));
  }
  ~gate() {
    open_ = true;
    cudaStreamSynchronize(stream_);
  }
  gate(const gate&) = delete;

 private:
  cudaStream_t stream_;
  std::atomic<bool> open_{false};
};

}  // namespace testing
