"""The pieces of benchmarks/in_turns.py, without its measurement."""

import ast
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import in_turns, short_runs


class Fake:
    """Answers as the process of a checkout would, and writes down what it was asked for."""

    def __init__(self, name, asked, seconds=(), error=None):
        self.name, self.asked, self.error = name, asked, error
        self.seconds = iter(seconds)

    def run(self, number):
        self.asked.append((self.name, number))
        if self.error is not None and number == 0:
            return {"error": self.error}
        return {"seconds": next(self.seconds), "iterations": 3, "end": [1.0, 2.0]}


def test_names_of_cases_are_unique():
    names = [(case.scheme, case.name) for case in short_runs.CASES]
    assert len(set(names)) == len(names)


def test_cases_use_the_public_interface_alone():
    tree = ast.parse(Path(short_runs.__file__).read_text(encoding="utf-8"))
    imported = {
        name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in ([node.module] if isinstance(node, ast.ImportFrom) else _names(node))
    }
    assert [name for name in imported if name.startswith("fem_lie")] == ["fem_lie"]
    used = {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "fl"
    }
    assert used <= set(fl.__all__)


def _names(node):
    return [alias.name for alias in node.names]


def test_both_checkouts_take_turns_and_the_first_run_does_not_count():
    asked = []
    both = [Fake("A", asked, (9.0, 2.0, 3.0)), Fake("B", asked, (9.0, 5.0, 4.0))]
    ((answers, seconds),) = in_turns.measure(both, [7], rounds=2).values()
    assert asked == [(name, 7) for name in "ABABBA"]
    np.testing.assert_array_equal(seconds, [[2.0, 5.0], [3.0, 4.0]])
    assert [answer["seconds"] for answer in answers] == [9.0, 9.0]


def test_a_case_that_fails_in_one_checkout_has_no_times():
    asked = []
    both = [Fake("A", asked, range(9)), Fake("B", asked, range(9), error="ValueError: no")]
    found = in_turns.measure(both, [0, 1], rounds=3)
    assert found[0][1].shape == (0, 2)
    assert found[1][1].shape == (3, 2)
    assert found[0][0][1]["error"] == "ValueError: no"
    assert asked.count(("A", 0)) == 1


def test_difference_of_ends():
    assert in_turns.difference([[4.0, 1.0], [4.0, 3.0]]) == 0.5
    assert in_turns.difference([[0.0], [0.0]]) == 0.0
    assert in_turns.difference([[1.0], [1.0, 2.0]]) == np.inf


def test_the_table_lists_what_is_above_the_limit(capsys):
    rows = [
        in_turns.Row("scheme", f"case {k}", (1.0, ratio), (1, 1), 0.0)
        for k, ratio in enumerate((0.5, 1.0, 1.2))
    ]
    in_turns.show(rows)
    shown = capsys.readouterr().out
    assert "median 1.000, largest 1.20" in shown
    assert shown.endswith("above 1.10: scheme, case 2: 1.20\n")


@pytest.mark.parametrize("case", [case for case in short_runs.CASES if case.scheme == "Hamel"])
def test_a_case_gives_the_same_end_again(case):
    one, other = case.run(), case.run()
    assert one.iterations == other.iterations > 0
    np.testing.assert_array_equal(one.end, other.end)
