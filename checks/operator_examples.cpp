#include "checks/operator_examples.h"

#include <string>
#include <utility>

namespace xrds {
namespace {

OperatorExample exampleOf(const ExampleMaker& maker, Operator op) {
  OperatorExample example{.graph = {.exposure = maker.madeExposure(), .madeWeights = maker.keptWeights()}};
  for (const ExampleValue& value : maker.values()) {
    example.graph.create("example", value.type, value.shape);
    example.ranges.push_back(value.range);
  }
  Node& node = example.graph.nodes.emplace_back(Node{"", std::move(op)});
  node.name = factsOf(node).name;
  return example;
}

template <class Op>
void addOperator(DataType stored, const DeviceTraits& device, std::vector<OperatorExample>& all) {
  ExampleMaker maker(stored, device);
  std::vector<Op> examples;
  addExamples(maker, examples);
  for (const Op& op : examples) all.push_back(exampleOf(maker, op));
}

template <class... Ops>
std::vector<OperatorExample> examplesOf(std::variant<Ops...>*, DataType stored, const DeviceTraits& device) {
  std::vector<OperatorExample> all;
  (addOperator<Ops>(stored, device, all), ...);
  return all;
}

}  // namespace

std::vector<OperatorExample> operatorExamples(Precision precision, const DeviceTraits& device) {
  const DataType stored = precision == Precision::fp16 ? DataType::f16 : DataType::f32;
  return examplesOf(static_cast<Operator*>(nullptr), stored, device);
}

}  // namespace xrds
