#pragma once

namespace CLI {
class App;
}

namespace xrds {

/// Each adds one verb to the command line; the verb's work runs in its callback and throws Failure.
void addUpscale(CLI::App& app);
void addAdvise(CLI::App& app);
void addDenoise(CLI::App& app);
void addImport(CLI::App& app);
void addCompare(CLI::App& app);
void addInfo(CLI::App& app);
void addDevices(CLI::App& app);
void addView(CLI::App& app);
void addDoctor(CLI::App& app);
void addTune(CLI::App& app);

/// The group of the measuring verbs, and its members.
void addBench(CLI::App& app);
void addBenchQuality(CLI::App& group);
void addBenchNetwork(CLI::App& group);
void addBenchTiles(CLI::App& group);
void addBenchSkip(CLI::App& group);
void addBenchStress(CLI::App& group);

}  // namespace xrds
