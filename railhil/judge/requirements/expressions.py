"""Conditions and values of a sentence, read word by word."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import NoReturn, TypeAlias

from railhil.judge.requirements import syntax
from railhil.judge.requirements.syntax import Condition, Value
from railhil.judge.requirements.words import END, FUNCTIONS, KEYWORDS, NAME, NUMBER, SentenceError, Word, words_of

Operand: TypeAlias = Value | Condition
_COMPARISONS = ("<", "<=", ">", ">=", "=", "!=")
#: Parentheses and words such as ``not`` deeper than this are refused.
_DEPTH_MAX = 50


class Expressions:
    """Reads a text from its first word on; the grammar is that of :mod:`railhil.judge.requirements.parser`."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._words = words_of(text)
        self._place = 0
        self._depth = 0

    @property
    def _next(self) -> Word:
        return self._words[self._place]

    def _take(self) -> Word:
        word = self._words[self._place]
        self._place += word.kind != END
        return word

    def _takes(self, *texts: str) -> bool:
        """Take the next word if it is one of these."""
        if self._next.kind != NUMBER and self._next.text in texts:
            self._place += 1
            return True
        return False

    def _expect(self, *texts: str) -> None:
        for text in texts:
            if not self._takes(text):
                self._refuse(f'"{text}" is missing before')

    def expect_end(self) -> None:
        """:raises SentenceError: there are further words."""
        if self._next.kind != END:
            self._refuse("the sentence could end before")

    def _refuse(self, problem: str, word: Word | None = None) -> NoReturn:
        word = word or self._next
        if word.kind == END:
            raise SentenceError(self._text.strip() or "nothing", f"{problem} the end", word.column)
        raise SentenceError(self._text[word.column : word.after], f"{problem} this word", word.column)

    def _until(self, first: int) -> tuple[int, int]:
        """Columns of the text from a column to the last word taken."""
        return first, self._words[self._place - 1].after

    def _event(self) -> Condition:
        word = self._next
        if word.kind == NAME and word.text not in KEYWORDS:
            self._take()
            return syntax.Occurs(word.column, word.after, word.text)
        if word.text not in ("begin", "end"):
            self._refuse("an event is missing before")
        return self._edge()

    def _edge(self) -> syntax.Edge:
        word = self._take()
        self._expect("of")
        found = self._condition(self._deeper(self._not))
        return syntax.Edge(*self._until(word.column), word.text, found)

    def _time(self) -> syntax.Number:
        word = self._next
        if word.kind != NUMBER:
            self._refuse("a time such as 20 ms is missing before")
        return self._number()

    def _number(self) -> syntax.Number:
        word = self._take()
        return syntax.Number(word.column, word.after, Fraction(word.text), word.unit)

    def condition(self) -> Condition:
        """A condition.

        :raises SentenceError: there is none.
        """
        return self._condition(self.either())

    def _condition(self, found: Operand) -> Condition:
        if isinstance(found, syntax.Name):
            return syntax.Occurs(found.column, found.after, found.name)
        if isinstance(found, Value):
            text = self._text[found.column : found.after]
            raise SentenceError(text, "is a value, and a condition is needed: compare it", found.column)
        assert isinstance(found, Condition)
        return found

    def _value(self, found: Operand) -> Value:
        if isinstance(found, Condition):
            text = self._text[found.column : found.after]
            raise SentenceError(text, "is a condition, and a value is needed", found.column)
        assert isinstance(found, Value)
        return found

    def either(self) -> Operand:
        """A condition, or a value that is not compared."""
        found = self._and()
        while self._takes("or"):
            left, right = self._condition(found), self._condition(self._and())
            found = syntax.Junction(left.column, right.after, "or", left, right)
        return found

    def _and(self) -> Operand:
        found = self._not()
        while self._takes("and"):
            left, right = self._condition(found), self._condition(self._not())
            found = syntax.Junction(left.column, right.after, "and", left, right)
        return found

    def _not(self) -> Operand:
        word = self._next
        if word.text in ("begin", "end") and word.kind == NAME:
            return self._edge()
        if self._takes("not"):
            of = self._condition(self._deeper(self._not))
            return syntax.Not(word.column, of.after, of)
        return self._comparison()

    def _comparison(self) -> Operand:
        found = self._sum()
        sign = self._next
        if self._takes("in"):
            value, listed = self._value(found), self._list()
            return syntax.OneOf(*self._until(found.column), value, listed)
        if not self._takes(*_COMPARISONS):
            return found
        left, right = self._value(found), self._value(self._sum())
        if self._next.text in _COMPARISONS:
            self._refuse("a comparison has two sides; join two with and before")
        return syntax.Compare(left.column, right.after, sign.text, left, right)

    def _list(self) -> tuple[syntax.Name, ...]:
        found: list[syntax.Name] = []
        self._expect("(")
        while not found or self._takes(","):
            found.append(self._name("a word"))
        self._expect(")")
        return tuple(found)

    def _name(self, what: str) -> syntax.Name:
        word = self._next
        if word.kind != NAME or word.text in KEYWORDS:
            self._refuse(f"{what} is missing before")
        self._take()
        return syntax.Name(word.column, word.after, word.text)

    def _sum(self) -> Operand:
        return self._chain(("+", "-"), self._product)

    def _product(self) -> Operand:
        return self._chain(("*", "/"), self._factor)

    def _chain(self, signs: tuple[str, ...], part: Callable[[], Operand]) -> Operand:
        found = part()
        while self._next.text in signs:
            sign = self._take().text
            left, right = self._value(found), self._value(part())
            found = syntax.Arithmetic(left.column, right.after, sign, left, right)
        return found

    def _factor(self) -> Operand:
        word = self._next
        if word.kind == NUMBER:
            return self._number()
        if self._takes("-"):
            if self._next.kind == NUMBER:
                number = self._number()
                return syntax.Number(word.column, number.after, -number.value, number.unit)
            of = self._value(self._deeper(self._factor))
            turned = syntax.Number(word.column, word.column, Fraction(-1), "")
            return syntax.Arithmetic(word.column, of.after, "*", turned, of)
        if self._takes("("):
            found = self._deeper(self.either)
            self._expect(")")
            return replace(found, column=word.column, after=self._words[self._place - 1].after)
        if word.kind == NAME and word.text in FUNCTIONS and self._words[self._place + 1].text == "(":
            return self._call()
        found = self._name("a value")
        if not self._takes("."):
            return found
        signal = self._name("a signal of the port")
        return syntax.PortSignal(word.column, signal.after, found.name, signal.name)

    def _call(self) -> syntax.Call:
        word = self._take()
        kinds = FUNCTIONS[word.text]
        values: list[Value] = []
        time = port = event = None
        self._expect("(")
        for place, kind in enumerate(kinds):
            if place:
                self._expect(",")
            if kind == "v":
                values.append(self._value(self._deeper(self.either)))
            elif kind == "t":
                time = self._time()
            elif kind == "p":
                port = self._name("a port")
            else:
                event = self._event()
        self._expect(")")
        return syntax.Call(*self._until(word.column), word.text, tuple(values), time, port, event)

    def _deeper(self, part: Callable[[], Operand]) -> Operand:
        self._depth += 1
        if self._depth > _DEPTH_MAX:
            raise SentenceError(self._next.text, f"is nested deeper than {_DEPTH_MAX}", self._next.column)
        found = part()
        self._depth -= 1
        return found
