// Writes checks/known_frame_answer.inc to standard output: the known frame, computed in double precision.
#include <cstdio>

#include "checks/known_frame.h"
#include "checks/reference.h"

int main() {
  const xrds::KnownFrame known;
  const xrds::Graph graph = buildGraph(known.model().config(), known.shape(), known.model().lookup(), {});
  xrds::HostMemory memory;
  setInputs(graph, known.input(), memory);
  runReference(graph, memory);
  int count = 0;
  for (uint32_t y = 0; y < graph.output.height; ++y)
    for (uint32_t x = 0; x < graph.output.width; ++x)
      for (uint32_t c = 0; c < 3; ++c)
        std::printf("%.9g,%s", memory.at(graph.output, y, x, c), ++count % 8 ? " " : "\n");
  std::printf("\n");
}
