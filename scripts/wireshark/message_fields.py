"""Puts together what protocol/messages.h says of each message: a table of plain lists and dictionaries, for make_fields. It
has

    messages   name, number on the wire, sender ("client", "server", "either"), comment and steps of each, in wire order. A
               step is a field (name, type, unit, about; what else its type needs: size, parts, enum, flags, hex;
               its limits: within has the least and the most value, and true if the least itself is outside, unit_length
               says of a vector how near to 1 its square is, and whether it may be 0; at_most bounds a count), steps under a flag (flag, of: the field; steps), or
               steps that repeat (count: factors of how often, most; each and room: what a time takes of how much; steps)
    enums      by name: the words for each number

The name of a field is its place in the message, as surface.tool_radius, without the frame or the unit at its end. Where
two messages, or a message and the dissector itself, mean different things by a name, the name of the message is in front:
telemetry.flags.
"""
import collections
import re

from cpp_declarations import Alias, Enum, NotUnderstood, Scope, number_of, read_headers, read_type, values_of
from cpp_visitors import If, Limit, Loop, steps_of

SCALARS = {"std::uint8_t": "u8", "std::uint16_t": "u16", "std::uint32_t": "u32", "std::uint64_t": "u64",
           "std::int64_t": "i64", "float": "f32", "double": "f64"}
SIZES = {"u8": 1, "u16": 2, "u32": 4, "u64": 8, "i64": 8, "f32": 4, "f64": 8}
# Units: those that a name ends in, and those that a comment mentions at its front or behind a comma.
SUFFIXES = {"_ns": "ns", "_hz": "Hz", "_percent": "%"}
ATOM = r"(?:m|s|N|kg|rad|1|%|sqrt\(kg\))"
# Fields that palpate_fields.lua has besides: of the header, and computed.
TAKEN = ("magic", "version", "type", "payload_length", "tag_length", "key", "reserved", "session", "sequence", "padding",
         "extra", "tag", "tag_verdict", "force", "age", "round_trip", "gap", "answers")
UNIT = re.compile(rf"(?:^|, )({ATOM}(?:[ /]{ATOM})*)(?=$|[,.;: ])")


# Words ----------------------------------------------------------------------------------------------------------------


def snake(name):
    """Of kHasTangent: has_tangent."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name.removeprefix("k")).lower()


def short(name):
    """A name without the frame or the unit at its end."""
    for suffix in ("_W", *SUFFIXES):
        name = name.removesuffix(suffix)
    return name


def unit_of(name, member, is_real):
    """By the end of the name; else, of a real number, by the comments: their units are those of the last members."""
    for suffix, unit in SUFFIXES.items():
        if name.endswith(suffix) or name == suffix[1:]:
            return unit
    units = UNIT.findall(member.about) or UNIT.findall(member.block)
    return units[-1 - member.later] if is_real and member.later < len(units) else None


def about(member):
    """The comment of a member, without the flags that it depends on."""
    return re.sub(r"^(with )?k[A-Z]\w*(, with k[A-Z]\w*)?(: ?|$)", "", member.about)


def limits_of(struct, one, type_):
    """The limits of a field, as the visitor names them; those of a real number are kAnyReal, if it names none."""
    name = (one.limits or ("kAnyReal" if type_ in ("f32", "f64") else "")).removeprefix("limits::")
    constant = struct.find("constants", name) if name else None
    if constant is None or constant.type.name not in ("Range", "UnitLength"):
        if one.limits:
            raise NotUnderstood(one.token.place, f"{struct.name}::fields: {one.limits} is no constant that limits a value",
                                "declare it: constexpr Range NAME{LEAST, MOST};")
        return {}
    values = [int(one) if isinstance(one, float) and one.is_integer() and abs(one) < 1e15 else one
              for one in values_of(constant)]
    return {"within": values} if constant.type.name == "Range" else \
        {"unit_length": {"tolerance": values[0], "or_zero": values[1]}}


def described(step, struct, one, member):
    """The step of a field, with its unit, comment and limits."""
    name = one.path[-1]
    kind = {"unit": unit_of(name, member, step["type"] in ("f32", "f64")), "about": about(member)}
    if "enum" not in step:
        kind.update(limits_of(struct, one, step["type"]))
    if "one bit each" in member.about:
        kind["hex"] = True
    return {**step, **{key: value for key, value in kind.items() if value}}


# Types ----------------------------------------------------------------------------------------------------------------


def resolve(type_, scope, place):
    """What a type is on the wire: a struct, an enum, or a dictionary: type, and what it needs; or element and size."""
    if type_.name in SCALARS:
        return {"type": SCALARS[type_.name]}
    if type_.name == "Vec3":
        return {"type": "f64", "parts": ["x", "y", "z"]}
    if type_.name == "Mat3":  # symmetric
        return {"element": {"type": "f64"}, "size": 6}
    if type_.name == "std::array" and len(type_.arguments) == 2:
        element = resolve(read_type(type_.arguments[0], place)[0], scope, place)
        return {"element": element, "size": number_of(type_.arguments[1], scope)}
    found = scope.find("types", type_.name)
    if found is None:
        raise NotUnderstood(place, f"the type {type_} is not one that is known on the wire",
                            f"write {', '.join(SCALARS)}, Vec3, Mat3, std::array, an enum or a struct")
    return resolve_alias(found) if isinstance(found, Alias) else found


def resolve_alias(alias):
    """An array is bytes or text, if its comment says so."""
    kind = resolve(alias.type, alias.scope, alias.place)
    if not isinstance(kind, dict) or not isinstance(kind.get("element"), dict) or "type" not in kind["element"]:
        return kind
    size = kind["size"] * SIZES[kind["element"]["type"]]
    if kind["element"] == {"type": "u8"} and alias.about.startswith("ASCII, then zeros"):
        return {"type": "text", "size": size}
    if alias.about.endswith(f"on the wire {size} bytes."):
        return {"type": "bytes", "size": size}
    return kind


def member_at(struct, visit):
    """The member at a place such as vertex[i].psi[k], and what its type is there."""
    kind, member = struct, None
    for name, has_index in zip(visit.path, visit.indices):
        member = kind.members.get(name) if isinstance(kind, Scope) else None
        if member is None:
            raise NotUnderstood(visit.token.place, f"{struct.name}::fields: m.{'.'.join(visit.path)} is no member",
                                "visit a member that is declared in front of the visitor")
        kind = resolve(member.type, member.scope, member.place)
        if has_index:
            kind = kind.get("element") if isinstance(kind, dict) else None
    return member, kind


def parts_of(member, count, structs):
    """The names of the numbers of an array: its comment, or that of the member it names, ends with them."""
    listed = re.search(rf"(?:\b\w{{1,2}}, ){{{count - 1}}}\w{{1,2}}$", member.about)
    if listed:
        return listed[0].split(", ")
    same = re.search(r"in the order of `(\w+)`\.?$", member.about)
    others = [struct.members[same[1]] for struct in structs if same[1] in struct.members] if same else []
    return parts_of(others[0], count, structs) if others else None


# Steps ----------------------------------------------------------------------------------------------------------------


class Table:
    """Gathers the table; `scope` is what the headers declare, `text` all they have."""

    def __init__(self, scope, text):
        self.scope, self.text, self.enums = scope, text, {}
        self.all_structs = [found for found in scope.types.values() if isinstance(found, Scope)]
        self.structs = {struct.name: self.steps(struct, steps_of(struct), [])
                        for struct in self.all_structs if struct.visitor is not None}

    def steps(self, struct, visited, before):
        """The steps of a struct; `before` has those in front of them."""
        steps = []
        for one in visited:
            read = {If: self.under_flag, Loop: self.loop, Limit: self.limit}.get(type(one), self.visit)
            steps += read(struct, one, before + steps)
        return steps

    def under_flag(self, struct, one, before):
        if one.flag not in flags_of(struct) or not has_field("flags", before):
            raise NotUnderstood(one.token.place, f"{struct.name}::fields: {one.flag} is no bit of flags that was visited",
                                f"visit m.flags before, and declare {one.flag} with the type of flags")
        return [{"flag": snake(one.flag), "steps": self.steps(struct, one.steps, before)}]

    def loop(self, struct, one, before):
        step, most = {"count": [short(name) if isinstance(name, str) else name for name in one.count]}, one.most
        if isinstance(most, tuple):
            most = size_of(struct, most, one.token)
        for name in [*step["count"], *([one.each] if one.each else [])]:
            if isinstance(name, str) and not has_field(name, before):
                raise NotUnderstood(one.token.place, f"{struct.name}::fields: the count {name} was not visited before",
                                    f"visit m.{name} in front of the loop")
        bounds = {"most": most, "each": one.each, "room": one.room}
        step.update({key: value for key, value in bounds.items() if value is not None})
        return [{**step, "steps": self.steps(struct, one.steps, before)}]

    def limit(self, struct, one, before):
        if not has_field(one.name, before):
            raise NotUnderstood(one.token.place, f"{struct.name}::fields: {one.name} was not visited before",
                                f"visit m.{one.name} in front of this line")
        next(step for step in before if step.get("name") == one.name)["at_most"] = one.most
        return []

    def visit(self, struct, one, _):
        member, kind = member_at(struct, one)
        name = ".".join((*one.path[:-1], short(one.path[-1])))
        if one.struct is not None and isinstance(kind, Scope) and kind.name == one.struct:
            return [{"name": name, "struct": kind.name}]
        if one.struct is None and isinstance(kind, Enum):
            self.enums[kind.name] = kind
            type_ = resolve(kind.type, self.scope, one.token.place)["type"]
            return [described({"name": name, "type": type_, "enum": kind.name}, struct, one, member)]
        if one.struct is None and isinstance(kind, dict):
            return [self.numbers(struct, name, kind, one, member)]
        raise NotUnderstood(one.token.place, f"{struct.name}::fields: m.{'.'.join(one.path)} has another type",
                            "write X::fields(m.member, v) for a struct X, v(m.member) for all else")

    def numbers(self, struct, name, kind, one, member):
        """The step of a number, or of several."""
        if "element" not in kind:
            step = described({"name": name, **kind}, struct, one, member)
            if one.path == ("flags",):
                step["flags"] = [[snake(flag), value] for flag, value in flags_of(struct).items()]
            return step
        element, size = kind["element"], kind["size"]
        if not isinstance(element, dict) or list(element) != ["type"]:
            raise NotUnderstood(one.token.place, f"{struct.name}::fields: m.{'.'.join(one.path)} is no array of numbers",
                                "visit its elements in a loop")
        parts = parts_of(member, size, self.all_structs) if element["type"] == "f64" else None
        if parts:
            return described({"name": name, **element, "parts": parts}, struct, one, member)
        return {"count": [size], "steps": [described({"name": name, **element}, struct, one, member)]}

    def words(self, enum):
        """By number: what `name_of` in the headers says of a value, else its name in words."""
        said = dict(re.findall(rf'case {enum.name}::(\w+):\s*return "([^"]*)";', self.text))
        return {number: said.get(name, snake(name).replace("_", " ")) for name, number in enum.values.items()}


def has_field(name, steps):
    return any(step.get("name") == name for step in steps)


def size_of(struct, path, token):
    """The size of the array that m.array.size() means."""
    member = struct.members.get(path[0]) if len(path) == 1 else None
    kind = resolve(member.type, member.scope, member.place) if member else None
    if not isinstance(kind, dict) or "element" not in kind:
        raise NotUnderstood(token.place, f"{struct.name}::fields: m.{'.'.join(path)} is no array",
                            "give the size of an array")
    return kind["size"]


def flags_of(struct):
    """The bits of `flags`: the constants of its type."""
    member, flags = struct.members.get("flags"), {}
    for name, constant in struct.constants.items() if member else []:
        if constant.type.name == member.type.name:
            flags[name] = number_of(constant.value, constant.scope)
            if flags[name].bit_count() != 1:
                raise NotUnderstood(constant.place, f"{struct.name}: {name} has the type of flags, but is not one bit",
                                    "give it another type, or one bit")
    return flags


# Messages -------------------------------------------------------------------------------------------------------------


def flat(steps, structs, prefix=""):
    """Steps with those of each struct in its place, and the names of fields as they are in the whole message."""
    found = []
    for step in steps:
        if "struct" in step:
            found += flat(structs[step["struct"]], structs, f"{prefix}{step['name']}.")
            continue
        step = dict(step)
        if "flag" in step:
            step["of"] = f"{prefix}flags"
        if "steps" in step:
            step["steps"] = flat(step["steps"], structs, prefix)
        found.append(renamed(step, lambda name: prefix + name, lambda name: name))
    return found


def renamed(step, new_name, new_of):
    """A step with other names of its own, of its counts and of its field of flags."""
    step = dict(step)
    for key, rename in (("name", new_name), ("each", new_name), ("of", new_of)):
        if key in step:
            step[key] = rename(step[key])
    if "count" in step:
        step["count"] = [new_name(one) if isinstance(one, str) else one for one in step["count"]]
    return step


def all_fields(steps):
    return [field for step in steps for field in (all_fields(step["steps"]) if "steps" in step else [step])]


def with_front(steps, names, front):
    """Steps with the name of the message in front of some names."""
    def rename(name):
        return f"{front}.{name}" if name in names else name
    steps = [renamed(step, rename, rename) for step in steps]
    return [{**step, "steps": with_front(step["steps"], names, front)} if "steps" in step else step for step in steps]


def name_apart(messages):
    """Puts the name of the message in front of names that would mean different things."""
    kinds = collections.defaultdict(set)
    for message in messages:
        for field in all_fields(message["steps"]):
            kinds[field["name"]].add(repr([field.get(key) for key in ("type", "unit", "parts", "enum", "flags", "size")]))
    shared = {name for name, found in kinds.items() if len(found) > 1} | set(TAKEN)
    for message in messages:
        message["steps"] = with_front(message["steps"], shared, snake(message["name"]))


def message_of(struct, types, steps):
    """Of a struct with a kType: its row."""
    constant = struct.constants["kType"]
    name = "".join(token.text for token in constant.value).removeprefix("MessageType::")
    if name not in types.values or struct.visitor is None:
        raise NotUnderstood(constant.place, f"{struct.name} has no MessageType, or no visitor",
                            f"add {name} to enum MessageType, and fields(Self& m, Visitor&& v) to {struct.name}")
    sender, _, meaning = types.about[name].partition(": ")
    if sender not in ("client", "server", "either"):
        raise NotUnderstood(constant.place, f"the comment of {name} in enum MessageType does not name its sender",
                            "write ///< client: ..., server: ... or either: ... behind it")
    return {"name": struct.name, "type": types.values[name], "sender": sender, "about": meaning, "steps": steps}


def table_of(path, name, root):
    """The table of a header; `name` is how errors call it."""
    scope, text = read_headers(path, name, root)
    table, types = Table(scope, text), scope.types.get("MessageType")
    if not isinstance(types, Enum):
        raise NotUnderstood(f"{name}:1", "there is no enum MessageType",
                            "declare it: enum class MessageType : std::uint8_t {...};")
    messages = [message_of(struct, types, flat(table.structs.get(struct.name, []), table.structs))
                for struct in table.all_structs if "kType" in struct.constants]
    name_apart(messages)
    return {"messages": sorted(messages, key=lambda message: message["type"]),
            "enums": {enum.name: table.words(enum) for enum in table.enums.values()}}
