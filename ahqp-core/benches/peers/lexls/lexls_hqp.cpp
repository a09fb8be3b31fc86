// Solves a set of hierarchical problems (`.hqp`) with LexLS. Prints the same as the program `hqp`: one line
// `INDEX STATUS ITERATIONS x_0 … x_{n-1}` per problem, and the times on standard error.
//
//     lexls_hqp FILE [--warm [--point]] [--repeat K]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <lexls/lexlsi.h>

namespace
{

/// Rows [A, lower, upper], or [lower, upper] of single variables.
struct Level
{
    LexLS::ObjectiveType type;
    std::vector<LexLS::Index> variables;
    LexLS::dMatrixType data;
};

struct Problem
{
    std::string index;
    LexLS::Index variables;
    std::vector<Level> levels;
};

/// Result of a solve: the STATUS column of `hqp`.
enum Status
{
    SOLVED = 0,
    ITERATION_LIMIT = 1,
    REFUSED = 4
};

struct Outcome
{
    Status status;
    LexLS::Index iterations;
    LexLS::dVectorType x;
    double microseconds;
    /// The active constraints at the end, level by level.
    std::vector<std::vector<LexLS::ConstraintActivationType>> active;
};

struct Options
{
    std::string file;
    bool warm  = false;
    bool point = false;
    int repeat = 1;
};

void expect(std::istream &in, const std::string &word)
{
    std::string found;
    if (!(in >> found) || found != word)
    {
        throw std::runtime_error("`" + word + "` expected, found `" + found + "`");
    }
}

template<typename Value>
Value read(std::istream &in)
{
    Value value;
    if (!(in >> value))
    {
        throw std::runtime_error("a number or a name is missing");
    }
    return value;
}

/// A level `B` becomes simple bounds if LexLS accepts them: first level, each variable once.
Level read_level(std::istream &in, LexLS::Index variables, bool first)
{
    expect(in, "level");
    const auto kind = read<std::string>(in);
    // LexLS treats all levels as objectives. A hard one is above all those that it limits.
    read<int>(in);
    const auto rows = read<LexLS::Index>(in);
    if (kind == "G")
    {
        LexLS::dMatrixType data(rows, variables + 2);
        for (LexLS::Index i = 0; i < rows; ++i)
        {
            for (LexLS::Index j = 0; j < variables + 2; ++j)
            {
                data(i, j) = read<double>(in);
            }
        }
        return {LexLS::GENERAL_OBJECTIVE, {}, data};
    }
    std::vector<LexLS::Index> bounded(rows);
    LexLS::dMatrixType bounds(rows, 2);
    for (LexLS::Index i = 0; i < rows; ++i)
    {
        bounded[i]   = read<LexLS::Index>(in);
        bounds(i, 0) = read<double>(in);
        bounds(i, 1) = read<double>(in);
        if (bounded[i] >= variables)
        {
            throw std::runtime_error("bounds of a variable that does not exist");
        }
    }
    if (first && std::set<LexLS::Index>(bounded.begin(), bounded.end()).size() == rows)
    {
        return {LexLS::SIMPLE_BOUNDS_OBJECTIVE, bounded, bounds};
    }
    LexLS::dMatrixType data = LexLS::dMatrixType::Zero(rows, variables + 2);
    data.rightCols(2)       = bounds;
    for (LexLS::Index i = 0; i < rows; ++i)
    {
        data(i, bounded[i]) = 1.0;
    }
    return {LexLS::GENERAL_OBJECTIVE, {}, data};
}

std::vector<Problem> read_set(const std::string &file)
{
    std::ifstream in(file);
    if (!in)
    {
        throw std::runtime_error("cannot open " + file);
    }
    expect(in, "hqpset");
    read<std::string>(in);
    const auto count = read<std::size_t>(in);
    std::vector<Problem> problems;
    for (std::size_t k = 0; k < count; ++k)
    {
        expect(in, "problem");
        Problem problem;
        problem.index = read<std::string>(in);
        read<std::string>(in);
        problem.variables = read<LexLS::Index>(in);
        const auto levels = read<std::size_t>(in);
        for (std::size_t level = 0; level < levels; ++level)
        {
            Level next = read_level(in, problem.variables, level == 0);
            // A level without rows needs no solve.
            if (next.data.rows() > 0)
            {
                problem.levels.push_back(next);
            }
        }
        problems.push_back(problem);
    }
    return problems;
}

bool same_shape(const Problem &a, const Problem &b)
{
    const auto same_rows = [](const Level &a, const Level &b)
    { return a.type == b.type && a.variables == b.variables && a.data.rows() == b.data.rows(); };
    return a.variables == b.variables && a.levels.size() == b.levels.size()
           && std::equal(a.levels.begin(), a.levels.end(), b.levels.begin(), same_rows);
}

/// Solves once, starting from the previous result if it is given. The time is measured from passing the
/// data until x is read.
Outcome solve(const Problem &problem, const Outcome *before, bool point)
{
    std::vector<LexLS::Index> rows;
    std::vector<LexLS::ObjectiveType> types;
    std::vector<std::vector<LexLS::Index>> variables;
    for (const Level &level : problem.levels)
    {
        rows.push_back(static_cast<LexLS::Index>(level.data.rows()));
        types.push_back(level.type);
        variables.push_back(level.variables);
    }
    const auto levels = static_cast<LexLS::Index>(problem.levels.size());
    // Otherwise LexLS uses its whole budget if it cycles.
    LexLS::ParametersLexLSI parameters;
    parameters.cycling_handling_enabled = true;

    Outcome outcome{REFUSED, 0, LexLS::dVectorType::Constant(problem.variables, NAN), 0.0, {}};
    const auto start = std::chrono::steady_clock::now();
    const auto stop  = [&]
    {
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
        outcome.microseconds                                 = time.count();
    };
    try
    {
        LexLS::internal::LexLSI solver(problem.variables, levels, rows.data(), types.data());
        solver.setParameters(parameters);
        for (LexLS::Index level = 0; level < levels; ++level)
        {
            const LexLS::dMatrixType &data = problem.levels[level].data;
            if (types[level] == LexLS::SIMPLE_BOUNDS_OBJECTIVE)
            {
                solver.setData(level, variables[level].data(), data);
            }
            else
            {
                solver.setData(level, data);
            }
        }
        if (before != nullptr)
        {
            if (point)
            {
                solver.set_x0(before->x);
            }
            for (LexLS::Index level = 0; level < levels; ++level)
            {
                for (LexLS::Index row = 0; row < rows[level]; ++row)
                {
                    const LexLS::ConstraintActivationType type = before->active[level][row];
                    if (type == LexLS::CTR_ACTIVE_LB || type == LexLS::CTR_ACTIVE_UB)
                    {
                        solver.api_activate(level, row, type);
                    }
                }
            }
        }
        const LexLS::TerminationStatus status = solver.solve();
        outcome.x                             = solver.get_x();
        stop();
        const bool solved =
            status == LexLS::PROBLEM_SOLVED || status == LexLS::PROBLEM_SOLVED_CYCLING_HANDLING;
        outcome.status     = solved ? SOLVED : ITERATION_LIMIT;
        outcome.iterations = solver.getFactorizationsCount();
        outcome.active.resize(levels);
        for (LexLS::Index level = 0; level < levels; ++level)
        {
            solver.getActiveCtr(level, outcome.active[level]);
        }
    }
    catch (const std::exception &error)
    {
        stop();
        std::fprintf(stderr, "problem %s: %s\n", problem.index.c_str(), error.what());
    }
    return outcome;
}

void print(const Problem &problem, const Outcome &outcome)
{
    std::printf("%s %d %u", problem.index.c_str(), static_cast<int>(outcome.status), outcome.iterations);
    for (Eigen::Index i = 0; i < outcome.x.size(); ++i)
    {
        std::printf(" %.16e", outcome.x(i));
    }
    std::printf("\n");
}

Options parse(int count, char **arguments)
{
    Options options;
    for (int i = 1; i < count; ++i)
    {
        const std::string argument = arguments[i];
        if (argument == "--warm")
        {
            options.warm = true;
        }
        else if (argument == "--point")
        {
            options.point = true;
        }
        else if (argument == "--repeat" && i + 1 < count)
        {
            options.repeat = std::max(1, std::stoi(arguments[++i]));
        }
        else if (options.file.empty() && argument.rfind("--", 0) != 0)
        {
            options.file = argument;
        }
        else
        {
            throw std::runtime_error("usage: lexls_hqp FILE [--warm [--point]] [--repeat K]");
        }
    }
    if (options.file.empty())
    {
        throw std::runtime_error("give the set to solve");
    }
    return options;
}

void run(const Options &options)
{
    const std::vector<Problem> problems = read_set(options.file);
    std::vector<double> times;
    double iterations = 0.0;
    for (int pass = 0; pass < options.repeat; ++pass)
    {
        Outcome last;
        const Problem *of_last = nullptr;
        for (const Problem &problem : problems)
        {
            const bool warm = options.warm && of_last != nullptr && same_shape(problem, *of_last);
            Outcome outcome = solve(problem, warm ? &last : nullptr, options.point);
            if (pass == 0)
            {
                print(problem, outcome);
            }
            times.push_back(outcome.microseconds);
            iterations += outcome.iterations;
            // A failed solve gives no start for the next.
            of_last = outcome.status == SOLVED ? &problem : nullptr;
            last    = std::move(outcome);
        }
    }
    if (times.empty())
    {
        throw std::runtime_error("the set holds no problems");
    }
    std::sort(times.begin(), times.end());
    // The nearest rank, as in `hqp`.
    const auto percentile = [&](std::size_t percent) { return times[(times.size() * percent + 99) / 100 - 1]; };
    std::fprintf(stderr, "median_us=%.3f p90_us=%.3f p99_us=%.3f max_us=%.3f mean_iterations=%.2f\n",
                 percentile(50), percentile(90), percentile(99), times.back(),
                 iterations / static_cast<double>(times.size()));
}

} // namespace

int main(int count, char **arguments)
{
    try
    {
        run(parse(count, arguments));
    }
    catch (const std::exception &error)
    {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
