#include "checks/operator_examples.h"

#include <string>
#include <utility>

#include "shaders/common/example.h"

namespace xrds {
namespace {

Graph graphOf(const ExampleMaker& maker, Operator op) {
  Graph graph{.madeWeights = maker.keptWeights()};
  for (const auto& [shape, type] : maker.values()) graph.create("example", type, shape);
  graph.nodes.push_back({"", std::move(op)});
  graph.nodes.front().name = factsOf(graph.nodes.front()).name;
  return graph;
}

template <class Op>
void addOperator(DataType stored, const DeviceTraits& device, std::vector<Graph>& graphs) {
  ExampleMaker maker(stored, device);
  std::vector<Op> examples;
  addExamples(maker, examples);
  for (const Op& op : examples) graphs.push_back(graphOf(maker, op));
}

template <class... Ops>
std::vector<Graph> graphsOf(std::variant<Ops...>*, DataType stored, const DeviceTraits& device) {
  std::vector<Graph> graphs;
  (addOperator<Ops>(stored, device, graphs), ...);
  return graphs;
}

}  // namespace

std::vector<Graph> operatorExamples(Precision precision, const DeviceTraits& device) {
  const DataType stored = precision == Precision::fp16 ? DataType::f16 : DataType::f32;
  return graphsOf(static_cast<Operator*>(nullptr), stored, device);
}

}  // namespace xrds
