"""Designs: the numbers of the program, scenes that they silence, and questions that make no sense."""

import json
import subprocess

import amontons
import numpy as np
import pytest

MU = "friction.coefficient"
VARIED = {f"module[*].{name}": "±5%" for name in ("m1", "m2", "k1", "k2", "k3", "k4", "k5", "k6")}


def test_set_1_squeals_only_with_a_fifth_more_friction_by_the_answer_of_the_program(programs, tmp_path, set1):
    friction = 1.2 * 1.1836
    given = [f"--vary={name}={text}" for name, text in VARIED.items()]
    command = [programs / "amontons", "study", "design", "set1", *given, "--vary=damping.beta=3e-5:6e-5"]
    options = [f"--friction=0:{friction!r}", "--starts=3", "--points=2", "--runs=4", "--longest=4", "-o", tmp_path / "study"]
    subprocess.run([*command, *options], check=True, capture_output=True)
    study = json.loads((tmp_path / "study" / "study.json").read_text())
    vary = {**VARIED, "damping.beta": (3e-5, 6e-5)}
    found = set1.design(vary, (0.0, friction), starts=3, points=2, runs=4, longest=4.0)
    assert {"margin": found["margin"], "found": found["found"]} == study["results"]
    assert found["vary"] == study["settings"]["vary"] and found["states"] == study["settings"]["states"]
    assert found["found"]["is_kept"] and len(found["values"]) <= 17

    designed = set1.with_values(found["values"])
    for mu in np.linspace(0.0, friction, 50):
        assert designed.with_values({MU: mu}).eigenvalues().real.max() < 0.0, mu
    assert set1.with_values({MU: friction}).verdict() == "unstable"


def test_what_costs_more_changes_less_and_equal_modules_change_together(set1):
    vary = {"module[*].k5": "±5%", "module[*].k6": (240e3, 260e3)}
    same, dear = (
        set1.design(vary, (0.0, 1.3), together=True, runs=0, starts=3, points=0, cost=cost)["found"]["design"]["changes"]
        for cost in (None, {"module[*].k6": 3.0})
    )
    assert len(same) == 2 and abs(dear[1]) < 0.3 * abs(same[1])


def test_one_value_of_friction_and_named_states_are_a_question(set1):
    found = set1.design({"module[*].k6": "±5%"}, 1.1, states=["Sl-Sl", "St"], runs=0)
    assert found["states"] == ["Sl-Sl", "St-St"] and found["found"]["checked"]["frictions"] == 1
    assert found["values"] == {} and found["found"]["design"]["size"] == 0.0


def test_questions_that_make_no_sense_are_answered_with_what_would(set1):
    k6, friction = {"module[*].k6": "±5%"}, (0.0, 1.4)
    driven = amontons.Scene.builtin("den_hartog")
    for ask, words in (
        (lambda: set1.design({}, friction), "nothing may change"),
        (lambda: set1.design("module[*].k6", friction), "give names with ranges"),
        (lambda: set1.design({"module[*].k6": "5"}, friction), "5 of module.*NAME=±20%"),
        (lambda: set1.design({"module[*].k6": 5.0}, friction), "is no range; give '±5%'"),
        (lambda: set1.design({"module[*].k6": (1.0, "x")}, friction), "give a number"),
        (lambda: set1.design(k6, (1.0, 0.0)), "give the smaller one first"),
        (lambda: set1.design(k6, (0.0, 1.0, 2.0)), "give one value, or the smallest"),
        (lambda: set1.design(k6, -1.0), "a friction coefficient of -1 is not possible"),
        (lambda: set1.design(k6, "much"), "friction = 'much' is impossible; give a number"),
        (lambda: set1.design(k6, friction, starts=0), "0 starts are not possible"),
        (lambda: set1.design(k6, friction, starts="many"), "starts = 'many' is impossible"),
        (lambda: set1.design(k6, friction, margin=-1.0), "the margin is a growth rate"),
        (lambda: set1.design(k6, friction, cost={"module[*].k6": 0.0}), "a factor from 0.001 to 1000"),
        (lambda: set1.design(k6, friction, cost=3.0), "give names with factors"),
        (lambda: set1.design(k6, friction, states=["X"]), "X"),
        (lambda: set1.design(k6, friction, runs=0, window=1.0), "window is for runs after pushes"),
        (lambda: set1.design(k6, friction, runs=0, pushes="uniform(0,1)"), "pushes is for runs after pushes"),
        (lambda: set1.design(k6, friction, pushes="uniform(0)"), "pushes: "),
        (lambda: driven.design({"spring.*.stiffness": "±5%"}, (0.1, 0.2)), "den_hartog has signals"),
    ):
        with pytest.raises(amontons.ArgumentError, match=words):
            ask()
