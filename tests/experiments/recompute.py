#!/usr/bin/env python3
"""Computes every number and verdict of claims.csv again, from the other files of this folder.

Needs Python 3.9 and nothing else. It shares no code with the program: intervals, rules and means are
written here a second time. Prints what differs and ends with status 1 if anything does.
"""

import csv
import gzip
import math
import sys
from collections import defaultdict
from pathlib import Path

FOLDER = Path(__file__).parent
# What two computations of a mean may differ by, relative to its size.
TOLERANCE = 1e-6


def read(path):
    opened = gzip.open(path, "rt", encoding="utf-8") if path.suffix == ".gz" else open(path, encoding="utf-8")
    with opened as file:
        return list(csv.DictReader(file))


def table(name, tables={}):
    if name not in tables:
        plain = FOLDER / f"{name}.csv"
        tables[name] = read(plain if plain.exists() else FOLDER / f"{name}.csv.gz")
    return tables[name]


def student_cdf(t, freedom):
    """Student's t distribution by the integral of its density (Simpson's rule)."""
    scale = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2)) / math.sqrt(freedom * math.pi)
    density = lambda x: scale * (1 + x * x / freedom) ** (-(freedom + 1) / 2)
    steps = 4_000
    width = t / steps
    inner = sum((4 if i % 2 else 2) * density(i * width) for i in range(1, steps))
    return 0.5 + width / 3 * (density(0) + inner + density(t))


def student_quantile(share, freedom, quantiles={}):
    if (share, freedom) not in quantiles:
        low, high = 0.0, 200.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if student_cdf(middle, freedom) < share else (low, middle)
        quantiles[share, freedom] = low
    return quantiles[share, freedom]


def sums(claim):
    """The weighted sum of means in each repetition that has rows for all terms, and the number of rows."""
    terms = []
    for term in claim["terms"].split(" | "):
        cells, weight = term.rsplit(": ", 1)
        terms.append((float(weight), [cell.split("=", 1) for cell in cells.split(" & ")]))
    values = defaultdict(lambda: [[] for _ in terms])
    for row in table(claim["table"]):
        repeat = row[claim["repeats_by"]] if claim["repeats_by"] else ""
        for place, (_, cells) in enumerate(terms):
            if row[claim["column"]] and all(row[key] == text for key, text in cells):
                values[repeat][place].append(float(row[claim["column"]]))
    whole = [lists for lists in values.values() if all(lists)]
    mean = lambda numbers: sum(numbers) / len(numbers)
    results = [sum(weight * mean(list_) for (weight, _), list_ in zip(terms, lists)) for lists in whole]
    return results, sum(len(list_) for lists in whole for list_ in lists)


def measure(claim):
    values, samples = sums(claim)
    mean = sum(values) / len(values)
    if not claim["repeats_by"]:
        return mean, mean, mean, samples
    sd = math.sqrt(sum((value - mean) ** 2 for value in values) / (len(values) - 1))
    share = 1 - 0.05 / int(claim["comparisons"]) / 2
    half = student_quantile(share, len(values) - 1) * sd / math.sqrt(len(values))
    return mean, mean - half, mean + half, samples


def verdict(claim, low, high):
    kind = claim["kind"]
    paper = float(claim["paper"]) if claim["paper"] else 0.0
    if kind == "nothing":
        return "not comparable"
    if kind == "number":
        half_unit = float(claim["half_unit"])
        if high < paper - half_unit or low > paper + half_unit:
            return "smaller" if high < paper else "larger"
        return "undecided" if high - low > abs(paper) / 2 else "confirmed"
    if kind in ("at least", "sign"):
        return "confirmed" if low > paper else "differs" if high < paper else "undecided"
    if kind == "at most":
        return "confirmed" if high < paper else "differs" if low > paper else "undecided"
    # A difference of stated size.
    if high < 0:
        return "differs"
    contains = low <= paper <= high
    if contains and low <= 0:
        return "undecided"
    if contains or (low >= paper / 2 and high <= 1.5 * paper):
        return "confirmed"
    return "smaller" if high < paper else "larger"


def main():
    claims, different = table("claims"), 0
    for claim in claims:
        value, low, high, samples = measure(claim)
        again = verdict(claim, low, high)
        close = all(
            math.isclose(one, float(claim[key]), rel_tol=TOLERANCE, abs_tol=TOLERANCE)
            for key, one in (("value", value), ("low", low), ("high", high))
        )
        if not close or again != claim["verdict"] or samples != int(claim["samples"]):
            different += 1
            print(f"{claim['stated']} ({claim['on']}): {value} ({low} to {high}), n {samples}, {again}; file: "
                  f"{claim['value']} ({claim['low']} to {claim['high']}), n {claim['samples']}, {claim['verdict']}")
    print(f"{len(claims)} measurements computed again, {different} different")
    return 1 if different or not claims else 0


if __name__ == "__main__":
    sys.exit(main())
