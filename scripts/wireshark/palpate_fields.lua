-- The fields of Palpate's messages as Wireshark shows them, what may be wrong with a datagram, and the numbers of a header
-- (protocol/README.md). What a message holds comes from palpate_table.lua, with the words of palpate_words.lua. For
-- palpate.lua: gives a function of both, so that nothing happens where Wireshark loads this file by itself.

return function(TABLE, words)
  local name_of, label_of, branch_of = words.name_of, words.label_of, words.branch_of
  local HEADER, TAG, LONGEST = 28, 16, 1200    -- bytes
  local HELLO_PAYLOAD = 256                    -- bytes that a Hello is padded to
  local VERSION = 2

  local types, type_names = {}, {}  -- number by name; name by number
  for _, message in ipairs(TABLE.messages) do
    types[message.name], type_names[message.type] = message.type, message.name
  end

  -- Fields --------------------------------------------------------------------------------------------------------------

  local F, all_fields = {}, {}  -- by name, without "palpate."; and as a list

  -- A field of several messages is one, if it has one kind and one label.
  local labels = {}
  local function field(kind, name, label, ...)
    if F[name] and labels[name] == kind .. label then return end
    if F[name] then error(("palpate_words.lua: two fields are called %s; give one another name there"):format(name), 0) end
    F[name], labels[name] = ProtoField[kind]("palpate." .. name, label, ...), kind .. label
    table.insert(all_fields, F[name])
  end

  -- Header.
  field("string", "magic", "Magic")
  field("uint8", "version", "Version")
  field("uint8", "type", "Type", base.DEC, type_names)
  field("uint16", "payload_length", "Payload (bytes)")
  field("uint8", "tag_length", "Tag (bytes)")
  field("uint8", "key", "Key (number; 0: none)")
  field("bytes", "reserved", "Reserved")
  field("uint64", "session", "Session", base.HEX)
  field("uint64", "sequence", "Sequence")
  -- Behind the fields.
  field("bytes", "padding", "Padding")
  field("bytes", "extra", "Bytes of a later version")
  field("bytes", "tag", "Tag")
  -- Derived.
  field("string", "tag_verdict", "tag")
  field("double", "force", "Size of the force (N)")
  field("double", "age", "Age of the force (ms)")
  field("double", "round_trip", "Round trip, from its ToolState (ms)")
  field("double", "gap", "Gap since the sample before (ms)")
  field("framenum", "answers", "Answers the ToolState of frame", base.NONE, frametype.REQUEST)
  field("string", "page.kind", "What the page holds")

  -- What the messages hold ---------------------------------------------------------------------------------------------

  local function in_words(name)
    local text = name:match("[^.]+$"):gsub("_", " ")
    return text:sub(1, 1):upper() .. text:sub(2)
  end

  local function with_unit(label, unit)
    if not unit then return label end
    local text, count = label:gsub("{unit}", (unit:gsub("%%", "%%%%")))
    return count > 0 and text or ("%s (%s)"):format(label, unit)
  end

  -- Steps of the table become steps of the dissector: fields with the names that users know, structs replaced by what they
  -- hold, and a `branch` where a line of the tree has all below it.

  local KINDS = {u8 = "uint8", u16 = "uint16", u32 = "uint32", u64 = "uint64", i64 = "int64", f32 = "float", f64 = "double",
                 bytes = "bytes", text = "stringz"}
  local BITS = {u8 = 8, u16 = 16, u32 = 32}

  local function is_part(flag) return flag:match("^has_") ~= nil end

  -- The name of a flag: the part that follows, or what it requests.
  local function flag_name(struct, flag, parts)
    local name = name_of(struct .. "." .. flag)
    if name then return name end
    return parts[flag] and flag:match("^has_(.*)") or (flag:gsub("^requests_", "wants_"))
  end

  local function flag_label(name, flag, is_a_part)
    local label, short = label_of(name), name:match("[^.]+$")
    if label then return label end
    if is_a_part then return ("\"%s\" follows"):format(short) end
    if flag:match("^requests_") then return ("Asks for \"%s\""):format(short:gsub("^wants_", "")) end
    return in_words(name)
  end

  -- The flags that have steps, by their names in the table.
  local function parts_of(steps)
    local parts = {}
    for _, step in ipairs(steps) do
      if step.flag and is_part(step.flag) then parts[step.flag] = true end
    end
    return parts
  end

  local flag_lists = {}  -- by the name of the field: pairs of name and mask
  local function add_flags(step, name, struct)
    local parts, list = parts_of(TABLE.structs[struct]), {}
    for _, flag in ipairs(step.flags) do
      local short, mask = flag_name(struct, flag[1], parts), flag[2]
      local full = name .. "." .. short
      field("bool", full, flag_label(full, flag[1], parts[flag[1]]), BITS[step.type], {"yes", "no"}, mask)
      table.insert(list, {short, mask})
    end
    flag_lists[name] = list
    return list
  end

  local function add_field(step, name, struct)
    local label, kind = label_of(name) or in_words(name), KINDS[step.type]
    local new = {name = name, type = step.type, size = step.size, parts = step.parts, unit = step.unit, label = label,
                 names = step.enum and TABLE.enums[step.enum], at_most = step.at_most}
    if step.parts then
      for _, part in ipairs(step.parts) do
        field(kind, name .. "." .. part, with_unit(label .. " " .. part, step.unit), step.about)
      end
    elseif kind == "float" or kind == "double" then
      field(kind, name, with_unit(label, step.unit), step.about)
    elseif kind == "bytes" or kind == "stringz" then
      field(kind, name, label, base[kind == "bytes" and "NONE" or "ASCII"], step.about)
    else
      local shown = (step.hex or step.flags) and base.HEX or base.DEC
      field(kind, name, with_unit(label, step.unit), shown, new.names, nil, step.about)
    end
    new.flags = step.flags and add_flags(step, name, struct)
    return new
  end

  local steps_of

  local function add_loop(step, struct, prefix)
    local function full(name)
      return type(name) == "string" and prefix .. (name_of(struct .. "." .. name) or name) or name
    end
    local new = {count = {}, most = step.most, room = step.room, each = full(step.each)}
    for i, factor in ipairs(step.count) do new.count[i] = full(factor) end
    new.steps = steps_of(step.steps, struct, prefix)
    new.branch = new.steps[1].name and branch_of(new.steps[1].name)
    return new
  end

  local function add_flagged(step, struct, prefix)
    local flag = flag_name(struct, step.flag, parts_of(TABLE.structs[struct]))
    return {of = name_of(struct .. ".flags") or "flags", flag = flag, steps = steps_of(step.steps, struct, prefix),
            branch = is_part(step.flag) and ("Part \"%s\""):format(flag) or nil}
  end

  function steps_of(steps, struct, prefix)
    local list = {}
    for _, step in ipairs(steps) do
      local name = step.name and prefix .. (name_of(struct .. "." .. step.name) or step.name)
      if step.struct then
        for _, inner in ipairs(steps_of(TABLE.structs[step.struct], step.struct, name .. ".")) do
          table.insert(list, inner)
        end
      elseif step.flag then
        table.insert(list, add_flagged(step, struct, prefix))
      elseif step.count then
        table.insert(list, add_loop(step, struct, prefix))
      else
        table.insert(list, add_field(step, name, struct))
      end
    end
    return list
  end

  local messages = {}  -- by number on the wire
  for _, message in ipairs(TABLE.messages) do
    messages[message.type] = {name = message.name, sender = message.sender,
                              steps = steps_of(TABLE.structs[message.name], message.name, "")}
  end
  words.check_used()

  -- What is wrong with a datagram ---------------------------------------------------------------------------------------

  local E, all_experts = {}, {}
  local function expert_info(name, text, in_group, severity)
    E[name] = ProtoExpert.new("palpate." .. name, text, expert.group[in_group], expert.severity[severity])
    table.insert(all_experts, E[name])
  end
  -- For these the receiver refuses the datagram.
  expert_info("bad_length", "Bad length", "MALFORMED", "ERROR")
  expert_info("bad_magic", "Not Palpate: wrong magic", "PROTOCOL", "WARN")
  expert_info("bad_version", "Unknown version", "UNDECODED", "WARN")
  expert_info("bad_type", "Reserved or unknown type", "UNDECODED", "WARN")
  expert_info("bad_reserved", "Reserved bytes are not 0", "PROTOCOL", "WARN")
  expert_info("not_finite", "Not a finite number", "PROTOCOL", "ERROR")
  expert_info("out_of_range", "Value out of range", "PROTOCOL", "WARN")
  expert_info("bad_tag", "Bad tag", "CHECKSUM", "ERROR")
  expert_info("no_tag", "No tag, though there is a key", "PROTOCOL", "WARN")
  -- These it drops, or takes notice of.
  expert_info("duplicate", "Duplicate sequence number", "SEQUENCE", "WARN")
  expert_info("old", "Old sequence number", "SEQUENCE", "WARN")
  expert_info("wild", "Sequence number far ahead", "SEQUENCE", "WARN")
  expert_info("overtaken", "Overtaken by a later datagram", "SEQUENCE", "NOTE")
  expert_info("lost", "Sequence numbers before this one are missing", "SEQUENCE", "NOTE")
  expert_info("stale", "Stale force", "PROTOCOL", "WARN")
  -- This is no fault of anybody's but the capture's.
  expert_info("cut", "Cut short by the capture", "UNDECODED", "NOTE")

  return {
    types = types, type_names = type_names, messages = messages, reasons = TABLE.enums.RefuseReason,
    constants = TABLE.constants, version = VERSION, header = HEADER, tag = TAG, longest = LONGEST,
    hello_payload = HELLO_PAYLOAD, no_nonce = ("\0"):rep(16),
    fields = F, all_fields = all_fields, flag_lists = flag_lists, experts = E, all_experts = all_experts,
  }
end
