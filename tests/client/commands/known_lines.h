#ifndef FASCICLE_TESTS_CLIENT_COMMANDS_KNOWN_LINES_H_
#define FASCICLE_TESTS_CLIENT_COMMANDS_KNOWN_LINES_H_

#include <array>

// The lines of documents that are not run as they are. Each must exist in some document.
namespace fascicle::testing {

struct ExcusedLine {
  const char* command;
  const char* why;
};

inline constexpr const char* kBuilds = "installs packages, builds, or runs tests: this test is a part of that";
inline constexpr const char* kFixedPort = "listens on a fixed port or writes outside of the test's folder";
inline constexpr const char* kEnded = "needs a job that runs, and those of this test have ended; cli_test runs it";

inline constexpr std::array kExcusedLines = {
    ExcusedLine{"deploy/demo", kBuilds},
    ExcusedLine{"deploy/check", kBuilds},
    ExcusedLine{"deploy/check slow", kBuilds},
    ExcusedLine{"deploy/build release voxel_test", kBuilds},
    ExcusedLine{"deploy/build release tests", kBuilds},
    ExcusedLine{"ctest --test-dir build/release -R Static -j 2", kBuilds},
    ExcusedLine{"deploy/bench", kBuilds},
    ExcusedLine{"deploy/bench tet_force", kBuilds},
    ExcusedLine{"deploy/bench tet_force _10k", kBuilds},
    ExcusedLine{"deploy/bench quasistatic --sizes 10000,50000,100000 --threads 1 --steps 1 --limit 300", kBuilds},
    ExcusedLine{"fascicled", kFixedPort},
    ExcusedLine{"fascicled --workers 4 --threads 2", kFixedPort},
    ExcusedLine{"fascicled --data /srv/fascicle --workers 4", kFixedPort},
    ExcusedLine{"fascicled --data /srv/fascicle --workers 4 &", kFixedPort},
    ExcusedLine{"fascicled --listen 0.0.0.0:7300 --allow-remote", kFixedPort},
    ExcusedLine{"fascicled --ttl 30d --disk-budget 200GB", kFixedPort},
    ExcusedLine{"fascicle pause jobs/3f2a", kEnded},
    ExcusedLine{"fascicle resume 3f2a", kEnded},
    ExcusedLine{"fascicle resume jobs/3f2a", kEnded},
    ExcusedLine{"fascicle pause jobs/...", kEnded},
    ExcusedLine{"fascicle list --watch", "ends with Ctrl-C; cli_test runs it"},
    ExcusedLine{"fascicle completion zsh > \"${fpath[1]}/_fascicle\"", "needs zsh"},
};

// Lines that take long: the program commands_slow_test runs the documents that have them.
inline constexpr std::array kSlowLines = {
    "fascicle run crushed_cube.json --out out",
    "fascicle run anconeus_loads.json --out out",
    "fascicle run scene.json --check",
    "fascicle run fusiform_isometric.json --out out",
    "fascicle run upper_arm.json --out out",
    "fascicle render out --frames all --colour activation --out lift.gif",
    "fascicle render out --frames all --smooth --out run.gif",
    "fascicle render 3f2a --out release.gif --frames all --fps 12",
    "fascicle render 3f2a --out round.gif --turntable 48 --smooth",
    "fascicle segment thigh.nii.gz --filter bias-field --filter wavelet --classes 4 --class 3 --opening 2 --picture "
    "muscles.png",
};

// What stands in a document for a name that a user has. `$JOB`, `$OTHER`, `$ID`, `$OTHER_ID` and `$SERVER` are real.
struct Placeholder {
  const char* written;
  const char* meant;
};

inline constexpr std::array kPlaceholders = {
    Placeholder{"jobs/3f2a", "$JOB"}, Placeholder{"jobs/...", "$JOB"},    Placeholder{"jobs/A", "$JOB"},
    Placeholder{"jobs/B", "$OTHER"},  Placeholder{"3f2a", "$ID"},         Placeholder{"77c1", "$OTHER_ID"},
    Placeholder{"77b0", "$OTHER_ID"}, Placeholder{"lab:7300", "$SERVER"}, Placeholder{"COMMAND", "run"},
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_COMMANDS_KNOWN_LINES_H_
