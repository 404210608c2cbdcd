-- The fields of Palpate's messages as Wireshark shows them, what may be wrong with a datagram, and the numbers of a header
-- (protocol/README.md). What a message holds comes from palpate_table.lua. For palpate.lua: gives a function of it, so that
-- nothing happens where Wireshark loads this file by itself.

return function(TABLE)
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
    if F[name] then error(("palpate_fields.lua: two fields are called %s; add it to TAKEN in message_fields.py"):format(name), 0) end
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

  -- The name without the part of the message that it lies in; letters of formulas stay as they are.
  local function in_words(name)
    local text = (name:match("%.(.*)") or name):gsub("[_.]", " ")
    return #text < 3 and text or text:sub(1, 1):upper() .. text:sub(2)
  end

  local function with_unit(label, unit)
    return unit and ("%s (%s)"):format(label, unit) or label
  end

  local KINDS = {u8 = "uint8", u16 = "uint16", u32 = "uint32", u64 = "uint64", i64 = "int64", f32 = "float", f64 = "double",
                 bytes = "bytes", text = "stringz"}
  local BITS = {u8 = 8, u16 = 16, u32 = 32}

  local function add_field(step)
    local name, kind, label = step.name, KINDS[step.type], in_words(step.name)
    step.label, step.names = label, step.enum and TABLE.enums[step.enum]
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
      field(kind, name, with_unit(label, step.unit), shown, step.names, nil, step.about)
    end
    for _, flag in ipairs(step.flags or {}) do
      field("bool", name .. "." .. flag[1], in_words(flag[1]), BITS[step.type], {"yes", "no"}, flag[2])
    end
  end

  -- Adds the fields of steps; gives a line of the tree, as `branch`, to a part that may follow, and to a number that repeats.
  local function add_fields(steps)
    for _, step in ipairs(steps) do
      if not step.steps then
        add_field(step)
      else
        add_fields(step.steps)
        local part = step.flag and step.flag:match("^has_(.*)")
        step.branch = part and ("Part \"%s\""):format((part:gsub("_", " ")))
        if step.count and #step.steps == 1 then step.branch = step.steps[1].label end
      end
    end
  end

  local messages = {}  -- by number on the wire
  for _, message in ipairs(TABLE.messages) do
    add_fields(message.steps)
    messages[message.type] = message
  end

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
    version = VERSION, header = HEADER, tag = TAG, longest = LONGEST,
    hello_payload = HELLO_PAYLOAD, no_nonce = ("\0"):rep(16),
    fields = F, all_fields = all_fields, experts = E, all_experts = all_experts,
  }
end
