"""Reads the declarations of a C++ header, as far as protocol/messages.h and what it includes have them: constants, enums,
aliases, structs with their members, and the visitor `fields` of a struct as tokens. For make_fields.
"""
import dataclasses
import re

TOKEN = re.compile(r"""
    (?P<behind>///<[^\n]*) | (?P<before>///[^\n]*) | (?P<none>//[^\n]*|/\*.*?\*/|^\#(?:include|pragma)[^\n]*|\s+)
    | (?P<word>[A-Za-z_]\w*(?:::[A-Za-z_]\w*)*) | (?P<number>\d(?:[eE][-+]\d|[\w.'])*) | (?P<string>"(?:[^"\\\n]|\\.)*"|'[^'\n]*')
    | (?P<mark>&&|\+\+|!=|<=|.)""", re.X | re.M | re.S)
OPENING, CLOSING = "([{", ")]}"


class NotUnderstood(Exception):
    """A construct that cannot be read, in one line: where, what, and what to change."""

    def __init__(self, place, what, change):
        super().__init__(f"{place}: {what}; {change}")


@dataclasses.dataclass(frozen=True)
class Token:
    kind: str   # before (a comment `///`), behind (`///<`), word, number, string, mark
    text: str
    place: str  # file and line


@dataclasses.dataclass
class Statement:
    tokens: list
    before: str  # the comment in front of it
    behind: str  # the comment behind it

    @property
    def words(self):
        return [token.text for token in self.tokens]

    @property
    def place(self):
        return self.tokens[0].place


@dataclasses.dataclass
class Type:
    name: str
    arguments: list  # of a template: tokens of each

    def __str__(self):
        inner = ", ".join("".join(token.text for token in tokens) for tokens in self.arguments)
        return f"{self.name}<{inner}>" if inner else self.name


@dataclasses.dataclass
class Constant:
    type: Type
    value: list  # tokens
    scope: object
    place: str


@dataclasses.dataclass
class Alias:
    type: Type
    about: str
    scope: object
    place: str


@dataclasses.dataclass
class Enum:
    name: str
    type: Type
    values: dict  # by name: number
    about: dict   # by name: comment


@dataclasses.dataclass
class Member:
    type: Type
    about: str   # its own comment
    block: str   # the comment in front of its declaration, or of one before
    later: int   # how many members its declaration has after this one
    scope: object
    place: str


@dataclasses.dataclass
class Scope:
    """All namespaces together, or one struct: what it declares, by name."""
    name: str
    outer: object = None
    about: str = ""
    constants: dict = dataclasses.field(default_factory=dict)
    types: dict = dataclasses.field(default_factory=dict)  # aliases, enums and structs
    members: dict = dataclasses.field(default_factory=dict)
    visitor: list = None  # tokens of `fields`

    def find(self, kind, name):
        scope = self
        while scope is not None:
            if name in getattr(scope, kind):
                return getattr(scope, kind)[name]
            scope = scope.outer
        return None


# Tokens and statements ------------------------------------------------------------------------------------------------


def tokens_of(text, file):
    line, tokens = 1, []
    for found in TOKEN.finditer(text):
        if found.lastgroup != "none":
            tokens.append(Token(found.lastgroup, found[0], f"{file}:{line}"))
        line += found[0].count("\n")
    return tokens


def comments_at(tokens, at, kind):
    """The text of all comments of that kind from `at` on, and the index after them."""
    texts = []
    while at < len(tokens) and tokens[at].kind == kind:
        texts.append(tokens[at].text.lstrip("/<").strip())
        at += 1
    return " ".join(texts), at


def end_of_statement(tokens, at):
    """The index after its semicolon, or after the body of a function or of a namespace."""
    depth, is_value, has_body = 0, False, tokens[at].text == "namespace"
    for i in range(at, len(tokens)):
        text = tokens[i].text
        if depth == 0 and text == ";":
            return i + 1
        if depth == 0 and text == "=":
            is_value = True
        if depth == 0 and text == "(" and not is_value:
            has_body = True
        depth += (text in OPENING) - (text in CLOSING)
        if depth == 0 and text == "}" and has_body:
            return i + 1
    raise NotUnderstood(tokens[at].place, f"the statement at '{tokens[at].text}' has no end", "close it")


def statements_of(tokens):
    at = 0
    while at < len(tokens):
        before, at = comments_at(tokens, at, "before")
        if at == len(tokens):
            return
        end = end_of_statement(tokens, at)
        behind, after = comments_at(tokens, end, "behind")
        yield Statement(tokens[at:end], before, behind)
        at = after


def split(tokens, mark):
    """Cuts tokens at each `mark` that lies in no bracket."""
    parts, depth = [[]], 0
    for token in tokens:
        depth += (token.text in OPENING + "<") - (token.text in CLOSING + ">")
        if depth == 0 and token.text == mark:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts


# Declarations ---------------------------------------------------------------------------------------------------------


def read_type(tokens, place):
    """The type at the front of tokens, and the tokens after it."""
    if not tokens or tokens[0].kind != "word":
        text = tokens[0].text if tokens else ""
        raise NotUnderstood(place, f"'{text}' is where a type is expected", "write TYPE NAME = VALUE;")
    if len(tokens) < 2 or tokens[1].text != "<":
        return Type(tokens[0].text, []), tokens[1:]
    depth = 0
    for i, token in enumerate(tokens):
        depth += (token.text == "<") - (token.text == ">")
        if depth == 0 and i > 0:
            return Type(tokens[0].text, split(tokens[2:i], ",")), tokens[i + 1 :]
    raise NotUnderstood(place, f"'{tokens[0].text}<' is not closed", "close it with '>'")


def named_values(tokens, place):
    """Of `a = 1, b{}, c;`: each name with the tokens of its value."""
    for part in split(tokens[:-1], ","):
        texts = [token.text for token in part]
        if not part or part[0].kind != "word" or (len(part) > 1 and texts[1] not in ("=", "{")):
            raise NotUnderstood(place, f"'{' '.join(texts)}' is not a declaration that is known",
                                "write TYPE NAME = VALUE; or NAME{}")
        yield part[0], part[2:] if len(part) > 1 and texts[1] == "=" else part[1:]


def declare_constants(statement, scope, _):
    tokens = [token for token in statement.tokens if token.text not in ("static", "constexpr", "inline")]
    type_, rest = read_type(tokens, statement.place)
    for name, value in named_values(rest, statement.place):
        scope.constants[name.text] = Constant(type_, value, scope, name.place)


def read_enum_value(tokens, enum, about):
    """Takes `NAME = NUMBER` into the enum; returns its name."""
    behind, end = comments_at(tokens, 3, "behind")
    is_known = [token.kind for token in tokens[:3]] == ["word", "mark", "number"] and tokens[1].text == "="
    if not is_known or end < len(tokens):
        raise NotUnderstood(tokens[0].place, f"{tokens[0].text} of {enum.name} has no number of its own",
                            "write NAME = NUMBER,")
    enum.values[tokens[0].text] = number_of(tokens[2:3], Scope(""))
    enum.about[tokens[0].text] = behind or about
    return tokens[0].text


def declare_flags(statement, scope):
    """Of a plain `enum NAME : TYPE {...}` in a struct: each value is a constant of that type."""
    opening = statement.words.index("{")
    type_, _ = read_type(statement.tokens[3:opening], statement.place)
    tokens = [token for token in statement.tokens[opening + 1 : -2] if token.kind not in ("before", "behind")]
    for part in split(tokens, ","):
        if part:
            read_enum_value(part, Enum(statement.words[1], type_, {}, {}), "")
            scope.constants[part[0].text] = Constant(type_, part[2:], scope, part[0].place)


def declare_enum(statement, scope, _):
    words = statement.words
    if len(words) > 5 and words[2] == ":" and "{" in words:
        declare_flags(statement, scope)
        return
    if len(words) < 8 or words[1] != "class" or words[3] != ":" or "{" not in words:
        raise NotUnderstood(statement.place, f"'{' '.join(words[:3])}' has no type on the wire",
                            "write enum class NAME : std::uint8_t {...};")
    opening = words.index("{")
    enum = Enum(words[2], read_type(statement.tokens[4:opening], statement.place)[0], {}, {})
    last = None
    for part in split(statement.tokens[opening + 1 : -2], ","):
        about, at = comments_at(part, 0, "behind")  # lies behind the comma of the value before
        if last is not None and about:
            enum.about[last] = about
        about, at = comments_at(part, at, "before")
        if at < len(part):
            last = read_enum_value(part[at:], enum, about)
    scope.types[enum.name] = enum


def declare_alias(statement, scope, _):
    words = statement.words
    if len(words) < 5 or words[2] != "=":
        raise NotUnderstood(statement.place, f"'using {words[1]}' declares no type", "write using NAME = TYPE;")
    type_, _ = read_type(statement.tokens[3:], statement.place)
    scope.types[words[1]] = Alias(type_, " ".join((statement.before, statement.behind)).strip(), scope, statement.place)


def declare_struct(statement, scope, _):
    words = statement.words
    if len(words) < 5 or words[2] != "{" or words[-2] != "}":
        raise NotUnderstood(statement.place, f"'{' '.join(words[:3])}' is not one that is known",
                            "write struct NAME {...};")
    struct = Scope(words[1], scope, statement.before)
    declare_all(statement.tokens[3:-2], struct)
    scope.types[struct.name] = struct


def declare_members(statement, scope, block):
    type_, rest = read_type(statement.tokens, statement.place)
    names = [name for name, _ in named_values(rest, statement.place)]
    if not names or scope.outer is None:
        raise NotUnderstood(statement.place, f"'{' '.join(statement.words)}' is no declaration that is known",
                            "declare constants, enums, aliases, structs and their members only")
    for i, name in enumerate(names):
        about = statement.behind or statement.before
        scope.members[name.text] = Member(type_, about, block, len(names) - 1 - i, scope, name.place)


def visited_by(name):
    """The struct that a visitor is of: X of X::fields, OtherTools of other_tools_fields; None: it is no visitor."""
    if name.endswith("::fields"):
        return name.removesuffix("::fields")
    return "".join(map(str.capitalize, name.split("_")[:-1])) if name.endswith("_fields") else None


def take_function(statement, scope, _):
    """Only visitors say something of the wire: `fields`, and that of a struct of another header, which comes in its place."""
    name = statement.words[statement.words.index("(") - 1]
    if name == "fields":
        scope.visitor = statement.tokens
    elif visited_by(name) in scope.types:
        struct = scope.types[visited_by(name)] = scope.types.pop(visited_by(name))
        struct.visitor = statement.tokens


READERS = {"enum": declare_enum, "using": declare_alias, "struct": declare_struct, "constexpr": declare_constants,
           "static": declare_constants, "inline": declare_constants}


def declare_all(tokens, scope, skips=False):
    """Takes all statements into a scope; `skips` passes over those that are not understood."""
    block = scope.about
    for statement in statements_of(tokens):
        block = statement.before or block
        if statement.words == [";"]:
            continue
        if statement.words[0] == "namespace":
            declare_all(statement.tokens[statement.words.index("{") + 1 : -1], scope, skips)
            continue
        is_function = statement.words[-1] == "}"
        read = take_function if is_function else READERS.get(statement.words[0], declare_members)
        try:
            read(statement, scope, block)
        except NotUnderstood:
            if not skips:
                raise


def read_headers(path, name, root):
    """All that a header declares, and of what it includes that which is understood; and the text of all of them."""
    text, scope = path.read_text(), Scope("")
    texts = [text]
    for included in re.findall(r'^#include "(.+)"', text, re.M):
        texts.append((root / included).read_text())
        declare_all(tokens_of(texts[-1], included), scope, skips=True)
    declare_all(tokens_of(text, name), scope)
    return scope, "\n".join(texts)


# Values ---------------------------------------------------------------------------------------------------------------


def values_of(constant):
    """Of `constexpr TYPE NAME{a, -b, true};`: the values in the braces."""
    return [value_of(tokens, constant) for tokens in split(constant.value[1:-1], ",")]


def value_of(tokens, constant):
    texts = [token.text for token in tokens]
    if texts in (["true"], ["false"]):
        return texts == ["true"]
    if texts[:1] == ["-"]:
        return -value_of(tokens[1:], constant)
    if len(texts) == 1 and re.fullmatch(r"\d[\d.']*e[-+]?\d+", texts[0]):
        return float(texts[0].replace("'", ""))
    if len(texts) == 1 and tokens[0].kind == "word":
        named = constant.scope.find("constants", texts[0])
        if named is not None:
            return value_of(named.value, named)
    return number_of(tokens, constant.scope)


def number_of(tokens, scope):
    """The value of a product of numbers and constants."""
    product = 1
    for i, token in enumerate(tokens):
        constant = scope.find("constants", token.text) if token.kind == "word" else None
        if i % 2 == 1 and token.text == "*":
            continue
        if i % 2 == 0 and constant is not None:
            product *= number_of(constant.value, constant.scope)
        elif i % 2 == 0 and re.fullmatch(r"0[xX][0-9a-fA-F']+|[\d']+", token.text.rstrip("uUlL")):
            product *= int(token.text.rstrip("uUlL").replace("'", ""), 0)
        else:
            raise NotUnderstood(token.place, f"'{token.text}' is not a number that is known",
                                "write a product of numbers and of constants of this header or of those it includes")
    return product
