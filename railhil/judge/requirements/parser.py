"""The grammar of the sentences, LL(1): one word decides what comes next. No part of a sentence is evaluated as code.

::

    sentence  = [scope ","] body
    scope     = "from" instant "to" instant | "after" event | "between" event "and" event
    instant   = time | "start" | "end" | event
    body      = "always" cond | "never" cond ["for" "longer" "than" time]
              | "whenever" cond "," [reaction] cond ["for" time | [","] "until" (cond | "end")]
              | "at" (event | "end") cond | "eventually" ["within" time] cond ["for" time]
    reaction  = "at" "once" | "within" time | "from" time "to" time
    cond      = and {"or" and};  and = not {"and" not};  not = "not" not | ("begin" | "end") "of" not | comparison
    comparison = sum [("<" | "<=" | ">" | ">=" | "=" | "!=") sum | "in" "(" word {"," word} ")"]
    sum       = product {("+" | "-") product};  product = factor {("*" | "/") factor}
    factor    = "-" factor | number [unit] | name | PORT "." Signal | function "(" ... ")" | "(" cond ")"
    event     = name | ("begin" | "end") "of" not
"""

from __future__ import annotations

from railhil.common.errors import did_you_mean
from railhil.judge.requirements import syntax
from railhil.judge.requirements.expressions import Expressions, Operand
from railhil.judge.requirements.syntax import Condition
from railhil.judge.requirements.words import NUMBER, Word

_BODIES = ("always", "never", "whenever", "at", "eventually")
_SCOPES = ("from", "after", "between")


def parse_sentence(text: str) -> syntax.Sentence:
    """The sentence.

    :raises SentenceError: it is not of the language.
    """
    return _Parser(text).sentence()


def parse_definition(text: str) -> Operand:
    """The value or condition that a name of ``[define]`` stands for.

    :raises SentenceError: as :func:`parse_sentence`.
    """
    parser = Expressions(text)
    found = parser.either()
    parser.expect_end()
    return found


class _Parser(Expressions):
    def sentence(self) -> syntax.Sentence:
        scope = None
        if self._next.text in _SCOPES:
            scope = self._scope()
            self._expect(",")
        found = syntax.Sentence(self._text, scope, self._body())
        self.expect_end()
        return found

    def _scope(self) -> syntax.Scope:
        word = self._take()
        first: syntax.Number | syntax.Limit | Condition
        last: syntax.Number | syntax.Limit | Condition | None = None
        if word.text == "from":
            first = self._instant()
            self._expect("to")
            last = self._instant()
        else:
            first = self._event()
            if word.text == "between":
                self._expect("and")
                last = self._event()
        return syntax.Scope(*self._until(word.column), word.text, first, last)

    def _instant(self) -> syntax.Number | syntax.Limit | Condition:
        word = self._next
        if word.kind == NUMBER:
            return self._time()
        return self._limit() if word.text == "start" or self._is_end else self._event()

    @property
    def _is_end(self) -> bool:
        """Whether the next word is the end of the record, and not that of a condition."""
        return self._next.text == "end" and self._words[self._place + 1].text != "of"

    def _limit(self) -> syntax.Limit:
        word = self._take()
        return syntax.Limit(word.column, word.after, word.text)

    def _body(self) -> syntax.Body:
        word = self._take()
        if word.text not in _BODIES:
            hint = did_you_mean(word.text, (*_BODIES, *_SCOPES))
            self._refuse(f"{', '.join(_BODIES)} is missing{f' ({hint})' if hint else ''} before", word)
        if word.text == "always":
            return self._always(word)
        if word.text == "never":
            return self._never(word)
        if word.text == "whenever":
            return self._whenever(word)
        return self._at(word) if word.text == "at" else self._eventually(word)

    def _always(self, word: Word) -> syntax.Always:
        condition = self.condition()
        return syntax.Always(*self._until(word.column), condition)

    def _never(self, word: Word) -> syntax.Never:
        condition, longer = self.condition(), None
        if self._takes("for"):
            self._expect("longer", "than")
            longer = self._time()
        return syntax.Never(*self._until(word.column), condition, longer)

    def _whenever(self, word: Word) -> syntax.Whenever:
        given = self.condition()
        self._expect(",")
        first = last = hold = None
        until: Condition | syntax.Limit | None = None
        if self._takes("at"):
            self._expect("once")
        elif self._takes("within"):
            last = self._time()
        elif self._takes("from"):
            first = self._time()
            self._expect("to")
            last = self._time()
        condition = self.condition()
        if self._takes("for"):
            hold = self._time()
        elif self._next.text in (",", "until"):
            self._takes(",")
            self._expect("until")
            until = self._limit() if self._is_end else self.condition()
        return syntax.Whenever(*self._until(word.column), given, condition, first, last, hold, until)

    def _at(self, word: Word) -> syntax.At:
        event = self._limit() if self._is_end else self._event()
        condition = self.condition()
        return syntax.At(*self._until(word.column), event, condition)

    def _eventually(self, word: Word) -> syntax.Eventually:
        within = self._time() if self._takes("within") else None
        condition = self.condition()
        hold = self._time() if self._takes("for") else None
        return syntax.Eventually(*self._until(word.column), condition, within, hold)
