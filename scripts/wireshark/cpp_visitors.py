"""Reads the visitor `fields` of a struct: what it visits, in wire order, as steps. For make_fields. A step is one of

    Visit(path, struct)    v(m.a), v(m.a.b), v(m.a[i].b): path ("a", "b"); X::fields(m.a, v) or x_fields(m.a, v): struct "X";
                           v(m.a, kLimits): limits "kLimits"
    If(flag, steps)        if ((m.flags & kBit) != 0) ...
    Loop(count, ...)       for (std::size_t i = 0; i < m.n && i < kMost && (i + 1) * m.each <= kRoom; ++i) ...
    Limit(name, most)      const auto n = std::min<std::size_t>(m.n, kMost);
"""
import dataclasses

from cpp_declarations import NotUnderstood, Token, number_of, visited_by


@dataclasses.dataclass
class Visit:
    path: tuple    # names of members
    indices: tuple  # for each: whether it has an index
    struct: str    # whose visitor is called, if one is
    limits: str    # the constant that says which values are allowed, if one does
    token: Token


@dataclasses.dataclass
class If:
    flag: str
    steps: list
    token: Token


@dataclasses.dataclass
class Loop:
    count: list   # factors: names of members, and numbers
    most: object  # how often at most: None, number, or path of an array, whose size it is
    each: str     # the member that says how much of `room` each time takes, or None
    room: object
    steps: list
    token: Token


@dataclasses.dataclass
class Limit:
    name: str
    most: int
    token: Token


class Body:
    """Tokens of a visitor, taken one after the other; the last is its closing brace."""

    def __init__(self, struct):
        tokens = [token for token in struct.visitor if token.kind not in ("before", "behind")]
        opening = [token.text for token in tokens].index("{")
        self.struct, self.limits, self.indices = struct, set(), []
        self.tokens, self.at = tokens[opening + 1 :], 0

    def fault(self, what, change):
        return NotUnderstood(self.tokens[self.at].place, f"{self.struct.name}::fields: {what}", change)

    def next(self):
        return self.tokens[self.at].text

    def take(self, *texts, change):
        """Takes tokens of these texts, all of them; `change` says what to write where they are others."""
        for text in texts:
            if self.next() != text:
                raise self.fault(f"'{self.next()}' is where '{text}' is expected", change)
            self.at += 1

    def take_name(self, change):
        if self.tokens[self.at].kind != "word":
            raise self.fault(f"'{self.next()}' is not a name", change)
        self.at += 1
        return self.tokens[self.at - 1].text

    def may_take(self, text):
        is_next = self.next() == text
        self.at += is_next
        return is_next


def steps_of(struct):
    """The steps of the visitor of a struct."""
    body, steps = Body(struct), []
    while body.at < len(body.tokens) - 1:
        steps += statement(body)
    return steps


def statement(body):
    first = body.next()
    if first == "if":
        return [condition(body)]
    if first == "for":
        return [loop(body)]
    if first == "const":
        return [limit(body)]
    return visits(body)


def block(body):
    """The steps of one statement, or of several in braces."""
    if not body.may_take("{"):
        return statement(body)
    steps = []
    while not body.may_take("}"):
        steps += statement(body)
    return steps


def condition(body):
    token, change = body.tokens[body.at], "write if ((m.flags & kBit) != 0)"
    body.take("if", "(", "(", "m", ".", "flags", "&", change=change)
    flag = body.take_name(change)
    body.take(")", "!=", "0", ")", change=change)
    return If(flag, block(body), token)


def limit(body):
    token, change = body.tokens[body.at], "write const auto n = std::min<std::size_t>(m.n, kMost);"
    body.take("const", "auto", change=change)
    name = body.take_name(change)
    body.take("=", "std::min", "<", "std::size_t", ">", "(", "m", ".", name, ",", change=change)
    most = body.tokens[body.at : body.at + 1]
    body.at += 1
    body.take(")", ";", change=change)
    body.limits.add(name)
    return Limit(name, number_of(most, body.struct), token)


def visits(body):
    steps = [visit(body)]
    while body.may_take(","):
        steps.append(visit(body))
    body.take(";", change="write v(m.a), v(m.b);")
    return steps


def visit(body):
    token, change = body.tokens[body.at], "write v(m.member), X::fields(m.member, v), if, or a counted for"
    name = body.take_name(change)
    struct = visited_by(name)
    if struct is None and name != "v":
        body.at -= 1
        raise body.fault(f"'{name}' is not a statement that is known", change)
    body.take("(", change=change)
    (path, indices), limits = place(body, change), None
    if struct:
        body.take(",", "v", change=change)
    elif body.may_take(","):
        limits = body.take_name(change)
    body.take(")", change=change)
    return Visit(path, indices, struct, limits, token)


def place(body, change):
    """Of m.a[i].b: the names ("a", "b"), and whether each has an index (True, False)."""
    path, indices = [], []
    body.take("m", change=change)
    if body.next() != ".":
        raise body.fault("'m' is not a member", change)
    while body.may_take("."):
        path.append(body.take_name(change))
        indices.append(body.may_take("["))
        if indices[-1]:
            index = body.take_name(change)
            if index not in body.indices:
                raise body.fault(f"the index '{index}' is not that of a loop around it", change)
            body.take("]", change=change)
    return tuple(path), tuple(indices)


# Loops ----------------------------------------------------------------------------------------------------------------

LOOP = "write for (std::size_t i = 0; i < m.n && i < kMost && (i + 1) * m.each <= kRoom; ++i)"


def loop(body):
    token = body.tokens[body.at]
    body.take("for", "(", "std::size_t", change=LOOP)
    index = body.take_name(LOOP)
    body.take("=", "0", ";", index, "<", change=LOOP)
    found = Loop(product(body), None, None, None, [], token)
    while body.may_take("&&"):
        bound(body, index, found)
    body.take(";", "++", index, ")", change=LOOP)
    body.indices.append(index)
    found.steps = block(body)
    body.indices.pop()
    return found


def bound(body, index, found):
    """A condition of a loop after its first."""
    if body.may_take("("):
        body.take(index, "+", "1", ")", "*", change=LOOP)
        found.each = factor(body)
        body.take("<=", change=LOOP)
        found.room = factor(body)
        is_known = isinstance(found.each, str) and isinstance(found.room, int)
    else:
        body.take(index, "<", change=LOOP)
        is_known, found.most = found.most is None, factor(body)
        is_known = is_known and not isinstance(found.most, str)
    if not is_known:
        raise body.fault("this condition of a loop is not one that is known", LOOP)


def product(body):
    factors = [factor(body)]
    while body.may_take("*"):
        factors.append(factor(body))
    if any(isinstance(one, tuple) for one in factors):
        raise body.fault("a loop has the size of an array as its first condition", LOOP)
    return factors


def factor(body):
    """The name of a member, a number, or of m.a.size() the path ("a",)."""
    if body.next() != "m":
        token = body.tokens[body.at]
        value = token.text if token.text in body.limits else number_of([token], body.struct)
        body.at += 1
        return value
    path, indices = place(body, LOOP)
    if path[-1] == "size" and body.may_take("("):
        body.take(")", change=LOOP)
        return path[:-1]
    if len(path) > 1 or any(indices) or path[0] in body.limits:
        raise body.fault(f"'m.{'.'.join(path)}' is not a count that is known", LOOP)
    return path[0]
