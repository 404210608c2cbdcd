-- The fields of Palpate's messages as Wireshark shows them, what may be wrong with a datagram, and the numbers of the
-- protocol (protocol/README.md). For palpate.lua: gives a function, so that nothing happens where Wireshark loads this
-- file by itself.

return function()
  -- The protocol --------------------------------------------------------------------------------------------------------

  local HEADER, TAG, LONGEST = 28, 16, 1200    -- bytes
  local HELLO_PAYLOAD = 256                    -- bytes that a Hello is padded to
  local HELLO, CHALLENGE, WELCOME, REFUSE, BYE, TOOL_STATE, FORCE_SAMPLE, TELEMETRY, POINTER, SURFACE_PAGE =
    1, 2, 3, 4, 5, 6, 7, 8, 9, 10

  local VERSION = 2

  local TYPE_NAMES = {
    [HELLO] = "Hello", [CHALLENGE] = "Challenge", [WELCOME] = "Welcome", [REFUSE] = "Refuse", [BYE] = "Bye",
    [TOOL_STATE] = "ToolState", [FORCE_SAMPLE] = "ForceSample", [TELEMETRY] = "Telemetry", [POINTER] = "Pointer",
    [SURFACE_PAGE] = "SurfacePage",
  }
  local REASONS = {[1] = "no free tool", [2] = "unknown session", [3] = "version"}
  local SOURCES = {[0] = "unknown", [1] = "estimated", [2] = "measured by a study", [3] = "none by construction"}

  -- Fields --------------------------------------------------------------------------------------------------------------

  local F, all_fields = {}, {}  -- by name, without "palpate."; and as a list

  local function field(kind, name, label, ...)
    F[name] = ProtoField[kind]("palpate." .. name, label, ...)
    table.insert(all_fields, F[name])
  end

  -- A field of several numbers: `name`.x and so on, below one line with all of them.
  local groups = {}  -- by name: label, unit and the names of the parts
  local XYZ, WXYZ, SYMMETRIC = {"x", "y", "z"}, {"w", "x", "y", "z"}, {"xx", "xy", "xz", "yy", "yz", "zz"}
  local function group(name, label, unit, parts)
    groups[name] = {label = label, unit = unit, parts = parts}
    for _, part in ipairs(parts) do
      field("double", name .. "." .. part, ("%s %s%s"):format(label, part, unit == "" and "" or " (" .. unit .. ")"))
    end
  end

  -- Bits of a field of flags, from bit 0: pairs of name and meaning.
  local flag_lists = {}
  local function flags(name, label, width, list)
    field("uint" .. width, name, label, base.HEX)
    flag_lists[name] = list
    for i, flag in ipairs(list) do
      field("bool", name .. "." .. flag[1], flag[2], width, {"yes", "no"}, 2 ^ (i - 1))
    end
  end

  -- Header.
  field("string", "magic", "Magic")
  field("uint8", "version", "Version")
  field("uint8", "type", "Type", base.DEC, TYPE_NAMES)
  field("uint16", "payload_length", "Payload (bytes)")
  field("uint8", "tag_length", "Tag (bytes)")
  field("uint8", "key", "Key (number; 0: none)")
  field("bytes", "reserved", "Reserved")
  field("uint64", "session", "Session", base.HEX)
  field("uint64", "sequence", "Sequence")
  -- Hello, Challenge, Welcome, Refuse.
  field("bytes", "nonce", "Nonce")
  field("uint64", "attempt", "Attempt (Hellos of this run)")
  field("bytes", "cookie", "Cookie")
  field("bytes", "server_nonce", "Server nonce")
  field("bytes", "padding", "Padding")
  field("uint8", "tool", "Tool")
  field("double", "rate", "Rate (Hz; 0: as fast as it can)")
  field("double", "tool_radius", "Tool radius (m)")
  field("uint8", "reason", "Reason", base.DEC, REASONS)
  -- ToolState.
  field("uint64", "tick", "Tick")
  field("uint64", "newest_sample", "Newest sample used (number; 0: none yet)")
  field("int64", "t", "t, of the client's clock (ns)")
  group("p", "Tool position p", "m", XYZ)
  group("v", "Tool velocity v", "m/s", XYZ)
  group("q", "Orientation q", "", WXYZ)
  field("uint16", "buttons", "Buttons (bits)", base.HEX)
  flags("state", "Flags", 16, {
    {"device_lost", "Device gave nothing usable"}, {"rearmed", "Re-armed at this tick"}, {"clutched", "Clutched"},
    {"wants_here", "Asks for \"here\""}, {"wants_ahead", "Asks for \"ahead\""}, {"wants_surface", "Asks for \"surface\""},
    {"asks_pages", "Asks for pages"}, {"wants_errors", "Asks for \"errors\""},
    {"in_pause", "Heard of a pause"},
  })
  field("int64", "lead", "Lead (ns)")
  field("uint64", "pages_taken", "Pages taken")
  field("uint32", "asked_version", "Surface version asked for")
  field("uint32", "asked_page", "Page asked for (number)")
  -- ForceSample.
  field("uint64", "sample", "Number of the sample")
  field("uint64", "tool_tick", "Tick it answers")
  field("int64", "tool_t", "t of that tick, of the client's clock (ns)")
  group("f", "Force on the tool f", "N", XYZ)
  group("torque", "Torque on the tool", "N m", XYZ)
  field("int64", "step", "Time of the server's step (ns)")
  flags("answer", "Flags", 32, {
    {"in_contact", "In contact"}, {"flagged", "Flagged: no settled answer"}, {"here", "\"here\" follows"},
    {"ahead", "\"ahead\" follows"}, {"surface", "\"surface\" follows"}, {"errors", "\"errors\" follows"},
    {"others", "\"others\" follows"}, {"modes", "\"modes\" follows"}, {"mean", "\"mean\" follows"},
    {"relaxed", "\"relaxed\" follows"}, {"wants_telemetry", "Asks for Telemetry"}, {"paused", "Paused"},
    {"loads", "\"loads\" follows"}, {"cuts", "\"cuts\" follows"}, {"cutting", "Cutting"},
  })
  group("here.surface_v", "Surface velocity", "m/s", XYZ)
  group("ahead.p", "Place ahead", "m", XYZ)
  group("ahead.f", "Force there", "N", XYZ)
  for _, place in ipairs({"here", "ahead"}) do
    group(place .. ".tangent", "Tangent dF/dp", "N/m", SYMMETRIC)
    group(place .. ".normal", "Surface normal", "", XYZ)
    field("double", place .. ".gap", "Gap between surface and tool (m)")
  end
  field("uint32", "surface.version", "Version of the surface model")
  field("uint32", "surface.vertices", "Vertices")
  field("uint32", "surface.triangles", "Triangles")
  field("double", "surface.tool_radius", "Tool radius (m)")
  field("double", "surface.tool_friction", "Tool friction (Coulomb's coefficient)")
  field("double", "surface.tool_compliance", "Tool compliance (m/N)")
  group("surface.shift", "Shift from rest", "m", XYZ)
  for _, error in ipairs({{"mesh", "Mesh"}, {"time_step", "Time step"}}) do
    field("uint8", "errors." .. error[1] .. "_source", error[2] .. ": source of its error", base.DEC, SOURCES)
    field("float", "errors." .. error[1], error[2] .. ": its error (% of the force's RMS)")
  end
  group("others.v", "Surface velocity by the other tools", "m/s", XYZ)
  group("others.compliance", "Compliance of the other tools", "m/N", SYMMETRIC)
  field("uint8", "modes.count", "Modes")
  field("float", "modes.q", "Amplitude q (m sqrt(kg))")
  field("float", "modes.v", "Rate q' (m sqrt(kg)/s)")
  field("uint8", "loads.count", "Modes that other tools drive")
  field("float", "loads.load", "Load of other tools on a mode (N/sqrt(kg))")
  field("uint32", "cuts", "Steps in which tissue has been removed")
  field("uint8", "relaxed.terms", "Terms of the Prony series")
  field("float", "relaxed.share", "Share g of the stress at once")
  field("float", "relaxed.time", "Relaxation time tau (s)")
  field("uint8", "relaxed.first", "First mode told of")
  field("uint8", "relaxed.count", "Modes told of")
  field("float", "relaxed.z", "Late amplitude z (m sqrt(kg))")
  field("uint8", "relaxed.vertices", "Vertices told of")
  field("uint16", "relaxed.vertex", "Vertex")
  field("float", "relaxed.psi", "Remembered force psi (N; x, y, z of each term)")
  group("mean", "Mean force over the step", "N", XYZ)
  -- Telemetry, and Pointer.
  flags("telemetry", "Flags", 16, {
    {"has_motors", "The device has motors"}, {"fault", "Force latched off"}, {"clutched", "Clutched"},
    {"device_lost", "Device gives nothing usable"}, {"fading", "Newest sample too old"}, {"paused", "Paused"},
  })
  field("uint32", "dt", "Between two ticks told (ns)")
  field("int64", "sample_age", "Age of the newest sample (ns)")
  field("uint32", "period", "Period of the loop, mean (ns)")
  field("uint32", "longest_period", "Period of the loop, longest (ns)")
  field("uint64", "ticks", "Ticks")
  field("uint64", "missed", "Ticks missed")
  field("float", "passivity_gain", "Gain of passivity")
  field("uint32", "faded", "Times that the force was faded")
  field("uint32", "clamped", "Ticks clamped")
  field("uint32", "slewed", "Ticks slewed")
  field("uint32", "damped", "Ticks damped")
  field("stringz", "device", "Device")
  field("stringz", "felt_law", "Law that is felt")
  field("uint8", "named", "Column of the law named")
  field("stringz", "law", "Its name")
  field("float", "law_error", "Its mean error (%; below 0: not known)")
  field("uint8", "laws", "Laws beside it")
  field("uint8", "count", "Ticks told")
  field("float", "felt", "Force felt (N)")
  field("float", "by_law", "Force by a law (N)")
  field("uint64", "pointer", "Number of the pointer")
  -- SurfacePage.
  field("uint32", "page.version", "Version of the surface model")
  field("uint32", "page", "Page")
  field("float", "page.value", "Value (unit: that of the page)")
  -- Behind the fields.
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
    types = {HELLO, CHALLENGE, WELCOME, REFUSE, BYE,
             TOOL_STATE, FORCE_SAMPLE, TELEMETRY, POINTER, SURFACE_PAGE},
    type_names = TYPE_NAMES, reasons = REASONS, sources = SOURCES,
    version = VERSION, header = HEADER, tag = TAG, longest = LONGEST, hello_payload = HELLO_PAYLOAD,
    no_nonce = ("\0"):rep(16),
    fields = F, all_fields = all_fields, groups = groups, flag_lists = flag_lists,
    experts = E, all_experts = all_experts,
  }
end
