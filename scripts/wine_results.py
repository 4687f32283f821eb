"""Counts the tests of a JSON of GoogleTest: passed, skipped, without a device, failed.

    python3 scripts/wine_results.py tests.json

A test is without a device where all that it says is that it found no Vulkan. Ends with 1 if any other failed."""
import json
import sys

# The last one is what Wine's own vulkan-1.dll says where it finds no driver.
NO_DEVICE = ("Vulkan loader", "no Vulkan device", "No Vulkan device", "vkCreateInstance gives -3")


def main():
    counts = {"passed": 0, "skipped": 0, "without a device": 0, "failed": 0}
    failed = []
    with open(sys.argv[1]) as file:
        suites = json.load(file)["testsuites"]
    for suite in suites:
        for test in suite["testsuite"]:
            messages = [failure["failure"] for failure in test.get("failures", [])]
            if messages and all(any(words in message for words in NO_DEVICE) for message in messages):
                kind = "without a device"
            elif messages:
                kind = "failed"
                failed.append((f"{suite['name']}.{test['name']}", messages[0]))
            else:
                kind = "skipped" if test.get("result") == "SKIPPED" else "passed"
            counts[kind] += 1
    for name, message in failed:
        print(f"FAILED {name}: {message.strip()[:300]}")
    print("Under Wine: " + ", ".join(f"{number} {kind}" for kind, number in counts.items()))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
