"""Events in words: a line a step and kind."""

from types import SimpleNamespace

from vasculo.pillars.events import Event
from vasculo.pillars.parameters import Angiogenesis
from vasculo.study.telling import event_lines, tell_events


def step(*events, shear_ratio=23.4):
    return SimpleNamespace(step=31, events=events, parameters=Angiogenesis(), shear_ratio=shear_ratio)


def happened(kind, *pillars):
    return Event(31, 1.0, kind, (0.0, 0.0), pillars)


def test_each_kind_has_its_line():
    assert event_lines(step(happened("closure"))) == [
        "step 31: the plexus is closing itself off: shear ratio 23.4 > 20"
    ]
    assert event_lines(step(happened("rest"))) == ["step 31: at rest, nothing moves any more"]
    assert event_lines(step(happened("border", (3, 7)))) == ["step 31: 1 pillar (3+7) joined a closed side"]
    assert event_lines(step(happened("vanish", (5,)), happened("vanish", (6,)))) == [
        "step 31: 2 pillars (5; 6) vanished"
    ]
    assert event_lines(step(happened("split", (1, 2), (90,)))) == ["step 31: 1 pillar (1+2, 90) came apart"]


def test_mergers_are_not_told_and_many_are_counted():
    assert event_lines(step(happened("merge", (1,), (2,)))) == []
    chain = tuple(range(9))
    lines = event_lines(step(*(happened("border", chain) for _ in range(6)), happened("merge", (1,), (2,))))
    assert lines == [
        "step 31: 6 pillars (0+1+2+3+...; 0+1+2+3+...; 0+1+2+3+...; 0+1+2+3+... and 2 more) joined a closed side"
    ]


def test_all_tellers_are_told():
    log, seen = [], []
    tell_events(log.append, seen.append)(step(happened("rest"), happened("vanish", (1,))))
    assert log == seen
    assert len(log) == 2
