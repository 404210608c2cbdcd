-- Wireshark and tshark show Palpate's datagrams with this: every field of protocol/README.md, version 2, what its
-- receiver would refuse, what was seen before, how old a force is, and whether a tag is good. How to install and use it:
-- README.md beside this file. Lua 5.2 or later; needs blake2b.lua beside it.
--
-- In this order: fields; what is wrong with a datagram; a reader of payloads; the messages; keys and tags; what is
-- remembered of each session; the lines of the Info column; the dissector.

local FOLDER = debug.getinfo(1, "S").source:match("^@?(.*[/\\])") or ""
local blake2b = dofile(FOLDER .. "blake2b.lua")

local palpate = Proto("palpate", "Palpate")
palpate.prefs.key_file = Pref.string("Key file", "", "Text file with lines of \"palpate-key NUMBER 64-HEX-DIGITS\"")

local PORT = 45130
local HEADER, TAG, LONGEST = 28, 16, 1200    -- bytes
local HELLO_PAYLOAD = 256                    -- bytes that a Hello is padded to
local STALE = 300                            -- ms of age at which a client begins to fade a force
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
  {"relaxed", "\"relaxed\" follows"},
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
palpate.fields = all_fields

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
palpate.experts = all_experts

-- A reader of payloads ------------------------------------------------------------------------------------------------

-- Walks a payload field by field, as the C++ reader does: adds each field to the tree, keeps its value by its name, and
-- its faults. Where the bytes run out a field is 0, and `short` is set.
local Reader = {}
Reader.__index = Reader

local function new_reader(range_of_bytes, tree)
  return setmetatable({bytes = range_of_bytes, at = 0, tree = tree, values = {}, faults = {}, short = false}, Reader)
end

function Reader:left()
  return self.bytes and self.bytes:len() - self.at or 0
end

function Reader:take(size)
  if self.short or self:left() < size then
    self.short = true
    return nil
  end
  self.at = self.at + size
  return self.bytes:range(self.at - size, size)
end

function Reader:fault(item, kind, text)
  item:add_proto_expert_info(E[kind], text)
  table.insert(self.faults, text)
end

-- A limit says what is wrong with a number, or nothing.
local function within(low, high)
  return function(x)
    if x < low or x > high then return ("is not within %.10g to %.10g"):format(low, high) end
  end
end
local function above_0_up_to(high)
  return function(x)
    if x <= 0 or x > high then return ("is not above 0 and up to %g"):format(high) end
  end
end
local function at_least_1(x)
  if x < 1 then return "is 0" end
end
local function one_of(names)
  return function(x)
    if not names[x] then return "has no meaning" end
  end
end
local HUGE, TOOLS = within(-1e9, 1e9), within(0, 7)

function Reader:number(name, size, getter, limit, tree)
  local bytes = self:take(size)
  if not bytes then return 0 end
  local value = bytes[getter](bytes)
  local item = (tree or self.tree):add_le(F[name], bytes)
  self.values[name] = value
  local x = type(value) == "number" and value or value:tonumber()
  if x ~= x or x == math.huge or x == -math.huge then
    self:fault(item, "not_finite", name .. " is not a finite number")
  elseif limit and limit(x) then
    self:fault(item, "out_of_range", name .. " " .. limit(x))
  end
  return value, item
end

function Reader:u8(name, limit) return self:number(name, 1, "le_uint", limit) end
function Reader:u16(name, limit) return self:number(name, 2, "le_uint", limit) end
function Reader:u32(name, limit) return self:number(name, 4, "le_uint", limit) end
function Reader:u64(name, limit) return self:number(name, 8, "le_uint64", limit) end
function Reader:i64(name, limit) return self:number(name, 8, "le_int64", limit) end
function Reader:f32(name, limit) return self:number(name, 4, "le_float", limit) end
function Reader:f64(name, limit) return self:number(name, 8, "le_float", limit) end

function Reader:raw(name, size)
  local bytes = self:take(size)
  if not bytes then return end
  self.tree:add(F[name], bytes)
  self.values[name] = bytes:raw()
end

-- Several f64 below one line of the tree; gives them as a list, with that line.
function Reader:group(name, limit)
  local of, size = groups[name], 8 * #groups[name].parts
  if self.short or self:left() < size then
    self.short = true
    return nil
  end
  local branch = self.tree:add(self.bytes:range(self.at, size), of.label)
  local list, texts = {}, {}
  for i, part in ipairs(of.parts) do
    list[i] = self:number(name .. "." .. part, 8, "le_float", limit, branch)
    texts[i] = ("%.6g"):format(list[i])
  end
  branch:append_text((": (%s)%s"):format(table.concat(texts, ", "), of.unit == "" and "" or " " .. of.unit))
  self.values[name] = list
  return list, branch
end

-- A group whose square must be one of those given, as that of a unit vector; or 0.
function Reader:unit(name, may_be_0)
  local list, branch = self:group(name, nil)
  if not list then return end
  local square = 0
  for _, x in ipairs(list) do square = square + x * x end
  if not (math.abs(square - 1) < 1e-6 or (may_be_0 and square == 0)) then
    self:fault(branch, "out_of_range", name .. " does not have length 1")
  end
end

-- A field of flags with its bits below; gives a table of those that are set, by name.
function Reader:flags(name, size)
  local value, item = self:number(name, size, "le_uint")
  local set = {}
  if not item then return set end
  for i, flag in ipairs(flag_lists[name]) do
    item:add_le(F[name .. "." .. flag[1]], self.bytes:range(self.at - size, size))
    set[flag[1]] = math.floor(value / 2 ^ (i - 1)) % 2 == 1
  end
  self.values[name .. "_set"] = set
  return set
end

-- Calls `work` with the tree one branch deeper.
function Reader:part(label, work)
  local outer, begin = self.tree, self.at
  if self:left() == 0 then
    self.short = true
    return
  end
  self.tree = outer:add(self.bytes:range(begin), label)
  work()
  self.tree:set_len(self.at - begin)
  self.tree = outer
end

-- The messages --------------------------------------------------------------------------------------------------------

local read_message = {}  -- by type: reads the fields of a payload in their order

read_message[HELLO] = function(r)
  r:raw("nonce", 16)
  r:raw("cookie", 16)
  r:u64("attempt")
  r:raw("padding", HELLO_PAYLOAD - 40)
end

-- Which Hello an answer is of.
local function read_hello_name(r)
  r:raw("nonce", 16)
  r:u64("attempt")
end

read_message[CHALLENGE] = function(r)
  read_hello_name(r)
  r:raw("cookie", 16)
end

read_message[WELCOME] = function(r)
  read_hello_name(r)
  r:raw("server_nonce", 16)
  r:u8("tool", TOOLS)
  r:f64("rate", within(0, 1e6))
  r:f64("tool_radius", above_0_up_to(1))
end

read_message[REFUSE] = function(r)
  read_hello_name(r)
  r:u8("reason", one_of(REASONS))
end

read_message[BYE] = function() end

read_message[TOOL_STATE] = function(r)
  r:u8("tool", TOOLS)
  r:u64("tick", at_least_1)
  r:u64("newest_sample")
  r:i64("t")
  r:group("p", HUGE)
  r:group("v", HUGE)
  r:unit("q")
  r:u16("buttons")
  local has = r:flags("state", 2)
  if has.wants_ahead then r:i64("lead", within(0, 1e10)) end
  if has.wants_surface then r:u64("pages_taken") end
  if has.asks_pages then
    r:u32("asked_version")
    for _ = 1, 8 do
      local page, item = r:u32("asked_page")
      if page == 0xffffffff then item:append_text(": none") end
    end
  end
end

local function read_linearisation(r, place)
  r:group(place .. ".tangent", HUGE)
  r:unit(place .. ".normal", true)
  r:f64(place .. ".gap", within(0, 1e9))
end

local function read_surface(r)
  local version = r:u32("surface.version")
  r:u32("surface.vertices", within(0, 20000))
  r:u32("surface.triangles", within(0, 40000))
  r:f64("surface.tool_radius", version == 0 and within(0, 1) or above_0_up_to(1))
  r:f64("surface.tool_friction", within(0, 10))
  r:f64("surface.tool_compliance", within(0, 1e6))
  r:group("surface.shift", HUGE)
end

local function read_modes(r)
  local amplitude = within(-1e6, 1e6)
  for _ = 1, math.min(r:u8("modes.count", within(0, 75)), 75) do
    r:f32("modes.q", amplitude)
    r:f32("modes.v", amplitude)
  end
end

local function read_relaxed(r)
  local amplitude = within(-1e6, 1e6)
  local terms = math.min(r:u8("relaxed.terms", within(0, 4)), 4)
  for _ = 1, terms do
    r:f32("relaxed.share", within(0, 1))
    r:f32("relaxed.time", within(0, 1e6))
  end
  r:u8("relaxed.first", within(0, 75))
  for _ = 1, math.min(r:u8("relaxed.count", within(0, 75)) * terms, 75) do r:f32("relaxed.z", amplitude) end
  for _ = 1, math.min(r:u8("relaxed.vertices", within(0, 16)), 16) do
    r:u16("relaxed.vertex")
    for _ = 1, 3 * terms do r:f32("relaxed.psi", amplitude) end
  end
end

-- The parts of a ForceSample, in their order on the wire.
local PARTS = {
  {"here", function(r)
    r:group("here.surface_v", HUGE)
    read_linearisation(r, "here")
  end},
  {"ahead", function(r)
    r:group("ahead.p", HUGE)
    r:group("ahead.f", HUGE)
    read_linearisation(r, "ahead")
  end},
  {"surface", read_surface},
  {"errors", function(r)
    for _, of in ipairs({"mesh", "time_step"}) do
      r:u8("errors." .. of .. "_source", one_of(SOURCES))
      r:f32("errors." .. of, within(0, 1e6))
    end
  end},
  {"others", function(r)
    r:group("others.v", HUGE)
    r:group("others.compliance", within(-1e6, 1e6))
  end},
  {"modes", read_modes},
  {"mean", function(r) r:group("mean", HUGE) end},
  {"relaxed", read_relaxed},
}

read_message[FORCE_SAMPLE] = function(r)
  r:u8("tool", TOOLS)
  r:u64("sample", at_least_1)
  r:u64("tool_tick")
  r:i64("tool_t")
  r:group("p", HUGE)
  r:group("f", HUGE)
  r:group("torque", HUGE)
  r:i64("step")
  local has = r:flags("answer", 4)
  for _, part in ipairs(PARTS) do
    if has[part[1]] then r:part("Part \"" .. part[1] .. "\"", function() part[2](r) end) end
  end
end

read_message[SURFACE_PAGE] = function(r)
  r:u8("tool", TOOLS)
  r:u32("page.version")
  r:u32("page", within(0, 0xfffffffe))
  r:part("Values", function()
    for _ = 1, 225 do r:f32("page.value", HUGE) end
  end)
end

-- Keys and tags -------------------------------------------------------------------------------------------------------

local keys = {}       -- by number: 32 bytes
local key_file_fault  -- why there are none, although a file was named

local function bytes_of_hex(text)
  return (text:gsub("%x%x", function(pair) return string.char(tonumber(pair, 16)) end))
end

local function read_key_file(path)
  keys, key_file_fault = {}, nil
  if path == "" then return end
  local file, why = io.open(path)
  if not file then
    key_file_fault = why
    return
  end
  local number_of_line = 0
  for line in file:lines() do
    number_of_line = number_of_line + 1
    local words = line:gsub("#.*", "")
    local number, hex = words:match("^%s*palpate%-key%s+(%d+)%s+(%x+)%s*$")
    if number and #hex == 64 and tonumber(number) >= 1 and tonumber(number) <= 255 then
      keys[tonumber(number)] = bytes_of_hex(hex)
    elseif words:match("%S") then
      key_file_fault = ("%s:%d: not \"palpate-key NUMBER 64-HEX-DIGITS\", with a number from 1 to 255"):format(
        path, number_of_line)
    end
  end
  file:close()
end

-- The key of one direction of one session. Kept, as every datagram of the session needs it.
local direction_keys = {}
local function direction_key(shared, from, client_nonce, server_nonce)
  local label = from == "client" and "client to server" or "server to client"
  local text = label .. ("\0"):rep(24 - #label) .. string.char(VERSION) .. client_nonce .. server_nonce
  local known = direction_keys[shared .. text] or blake2b(text, 32, shared)
  direction_keys[shared .. text] = known
  return known
end

local NO_NONCE = ("\0"):rep(16)
local BEFORE_SESSION = {[HELLO] = true, [CHALLENGE] = true, [WELCOME] = true, [REFUSE] = true}

-- The verdict on a tag, in words. `all` is the datagram without its tag; `session` is what is known of it, or nil.
local function judge_tag(d, all, tag, session)
  if key_file_fault then return ("cannot be checked (%s)"):format(key_file_fault) end
  if not next(keys) then return "not checked (no key file is named)" end
  if not keys[d.key] then return ("cannot be checked (key %d is not in the key file)"):format(d.key) end
  local client_nonce, server_nonce = d.values.nonce, NO_NONCE
  if not BEFORE_SESSION[d.type] then
    if not (session and session.server_nonce) then
      return "cannot be checked (the Welcome is not in the capture)"
    end
    client_nonce, server_nonce = session.client_nonce, session.server_nonce
  end
  local key = direction_key(keys[d.key], d.from, client_nonce, server_nonce)
  return blake2b(all, TAG, key) == tag and "good" or "bad"
end

-- What is remembered of each session ----------------------------------------------------------------------------------

local sessions = {}  -- by number, as text
local results = {}   -- by frame: what the first pass found; the passes after it only show that

-- Which sequence numbers of one sender were seen: the rules of protocol/replay_window.h.
local Window = {}
Window.__index = Window
local WINDOW, NEAR, ENOUGH = 64, 64, 4

local function new_window(farthest)
  return setmetatable({farthest = farthest, seen = {}, in_a_row = 0, last_wild = 0}, Window)
end

-- A number far ahead is wild, but for the fourth in a row, each a little beyond the one before.
function Window:is_new_beginning(n)
  local goes_on = self.in_a_row > 0 and n > self.last_wild and n - self.last_wild <= NEAR
  self.in_a_row = goes_on and self.in_a_row + 1 or 1
  self.last_wild = n
  if self.in_a_row < ENOUGH then return false end
  self.in_a_row = 0
  return true
end

-- Takes a number. Gives whether it is new, and what is to be said of it: kind and text. As a capture may begin anywhere,
-- the first number of all is taken whatever it is; as it may lack what the receiver got, one that is wild is new, too.
function Window:take(n)
  local highest = self.highest or n - 1
  if n <= highest then
    if self.seen[n] then return false, "duplicate", ("sequence %.0f was seen before"):format(n) end
    if highest - n >= WINDOW then
      return false, "old", ("sequence %.0f is %.0f behind the highest"):format(n, highest - n)
    end
    self.seen[n] = true
    return true, "overtaken", ("sequence %.0f was overtaken by %.0f"):format(n, highest)
  end
  local ahead = n - highest
  if ahead > self.farthest and not self:is_new_beginning(n) then
    return true, "wild", ("sequence %.0f is %.0f ahead of the highest; a receiver that saw no more drops it"):format(n, ahead)
  end
  self.in_a_row, self.highest, self.seen[n] = 0, n, true
  if ahead > 1 then return true, "lost", ("missing before this one: %.0f"):format(ahead - 1) end
  return true
end

local function session_of(id)
  sessions[id] = sessions[id] or {
    ticks = {}, tool_ts = {}, surfaces = {},
    windows = {client = new_window(100), server = new_window(24)},  -- as far ahead as their receivers take
  }
  return sessions[id]
end

-- Of two times, a - b in seconds, ms to the microsecond.
local function ms_between(a, b) return math.floor((a - b) * 1e6 + 0.5) / 1e3 end

local follow = {}  -- by type: what an accepted datagram tells of its session, and what the session tells of it

-- A Welcome whose tag is good is not replaced by one whose tag is not.
follow[WELCOME] = function(d, session, result)
  if session.is_proven and result.tag_verdict ~= "good" then return end
  session.client_nonce, session.server_nonce = d.values.nonce, d.values.server_nonce
  session.client, session.is_proven = d.destination, result.tag_verdict == "good"
end

follow[TOOL_STATE] = function(d, session, result)
  session.client = session.client or d.source
  session.ticks[tostring(d.values.tick)] = {time = d.time, frame = d.frame}
  local used = session.tool_ts[tostring(d.values.newest_sample)]
  if used then result.age = ms_between((d.values.t - used):tonumber() / 1e9, 0) end
end

follow[FORCE_SAMPLE] = function(d, session, result)
  local v = d.values
  local asked = session.ticks[tostring(v.tool_tick)]
  if asked then
    result.round_trip, result.answers = ms_between(d.time, asked.time), asked.frame
    result.age = result.round_trip
  end
  if session.last_sample then result.gap = ms_between(d.time, session.last_sample) end
  session.last_sample = d.time
  session.tool_ts[tostring(v.sample)] = v.tool_t
  if v.answer_set.surface then
    session.surfaces[v["surface.version"]] = {
      vertices = v["surface.vertices"], triangles = v["surface.triangles"], modes = v["modes.count"] or 0}
  end
end

local PER_PAGE, CLUSTER, MODES_PER_PAGE = 75, 5, 15

-- What a page holds: the rules of protocol/surface_pages.h.
local function kind_of_page(page, of)
  local function pages(count, each) return math.ceil(count / each) end
  local positions, triangles = pages(of.vertices, PER_PAGE), pages(of.triangles, PER_PAGE)
  local clusters, mode_groups = pages(of.vertices, CLUSTER), pages(of.modes, MODES_PER_PAGE)
  local tiles = clusters * (clusters + 1) / 2
  if page < positions then return ("positions of vertices from %d, m"):format(page * PER_PAGE) end
  page = page - positions
  if page < triangles then return ("triangles from %d, vertex numbers"):format(page * PER_PAGE) end
  page = page - triangles
  if page < tiles then
    local a = math.floor((math.sqrt(8 * page + 1) - 1) / 2)
    return ("compliance between clusters %d and %d, m/N"):format(a, page - a * (a + 1) / 2)
  end
  page = page - tiles
  if mode_groups > 0 and page == 0 then return "spectrum of the modes, rad/s and 1/s" end
  if mode_groups == 0 or page > clusters * mode_groups then return "beyond the last page" end
  return ("shapes of modes from %d at cluster %d, 1/sqrt(kg)"):format(
    (page - 1) % mode_groups * MODES_PER_PAGE, math.floor((page - 1) / mode_groups))
end

follow[SURFACE_PAGE] = function(d, session, result)
  local surface = session.surfaces[d.values["page.version"]]
  if surface then result.page_kind = kind_of_page(d.values.page, surface) end
end

local COUNTED = {[WELCOME] = true, [BYE] = true, [TOOL_STATE] = true, [FORCE_SAMPLE] = true, [SURFACE_PAGE] = true}

-- The first pass over a datagram that its receiver would read: the verdict on its tag, on its sequence number, and what
-- follows from those before it.
local function examine(d, all, tag)
  local result = {experts = {}}
  local function say(kind, text) table.insert(result.experts, {kind, text}) end
  if not d.is_whole then return result end
  if tag then
    result.tag_verdict = judge_tag(d, all, tag, sessions[d.session])
    if result.tag_verdict == "bad" then
      say("bad_tag", "the tag is not that of these bytes under the session's key")
      return result
    end
  elseif next(keys) then
    say("no_tag", "no tag, though the key file holds a key")
    local session = sessions[d.session]
    if session and session.is_proven then return result end
  end
  if not COUNTED[d.type] or #d.faults > 0 then return result end
  local session = session_of(d.session)
  local is_new, kind, text = session.windows[d.from]:take(d.sequence)
  if kind then say(kind, text) end
  if is_new and follow[d.type] then follow[d.type](d, session, result) end
  if result.age and result.age > STALE then say("stale", ("the force is %.3f ms old"):format(result.age)) end
  return result
end

function palpate.init()
  sessions, results, direction_keys = {}, {}, {}
  read_key_file(palpate.prefs.key_file)
end

-- The lines of the Info column ----------------------------------------------------------------------------------------

local function in_mm(p) return ("(%.2f, %.2f, %.2f) mm"):format(p[1] * 1e3, p[2] * 1e3, p[3] * 1e3) end
local function size_of(f) return math.sqrt(f[1] ^ 2 + f[2] ^ 2 + f[3] ^ 2) end
local function hex_of(bytes) return (bytes:gsub(".", function(c) return ("%02x"):format(c:byte()) end)) end

-- The names of the flags that are set.
local function names_of(name, set)
  local names = {}
  for _, flag in ipairs(flag_lists[name]) do
    if set[flag[1]] then table.insert(names, flag[1]) end
  end
  return table.concat(names, ",")
end

local info_of = {}  -- by type: what matters of a whole message

info_of[HELLO] = function(v)
  return (" nonce %s%s"):format(hex_of(v.nonce), v.cookie == NO_NONCE and "" or ", with a cookie")
end
info_of[CHALLENGE] = function(v) return " nonce " .. hex_of(v.nonce) end
info_of[WELCOME] = function(v)
  return (" nonce %s, tool %d, %g Hz, radius %g mm"):format(hex_of(v.nonce), v.tool, v.rate, v.tool_radius * 1e3)
end
info_of[REFUSE] = function(v) return " " .. (REASONS[v.reason] or "for an unknown reason") end
info_of[BYE] = function() return "" end
info_of[TOOL_STATE] = function(v, result)
  return (" tool %d, tick %s, p %s, used sample %s%s%s"):format(
    v.tool, tostring(v.tick), in_mm(v.p), tostring(v.newest_sample),
    result.age and (", %.1f ms old"):format(result.age) or "", v.state == 0 and "" or ", " .. names_of("state", v.state_set))
end
info_of[FORCE_SAMPLE] = function(v, result)
  return (" tool %d, number %s, answers tick %s%s, |f| %.3f N%s"):format(
    v.tool, tostring(v.sample), tostring(v.tool_tick),
    result.round_trip and (" after %.1f ms"):format(result.round_trip) or "", size_of(v.f),
    v.answer == 0 and "" or ", " .. names_of("answer", v.answer_set))
end
info_of[SURFACE_PAGE] = function(v, result)
  return (" tool %d, page %d of model %d%s"):format(
    v.tool, v.page, v["page.version"], result.page_kind and ": " .. result.page_kind or "")
end

-- The dissector -------------------------------------------------------------------------------------------------------

-- Who sent a datagram: the type tells, but for a Bye. That is the server's unless it comes from the client's address.
local FROM_CLIENT = {[HELLO] = true, [TOOL_STATE] = true, [TELEMETRY] = true}
local function sender_of(d)
  if d.type ~= BYE then return FROM_CLIENT[d.type] and "client" or "server" end
  local session = sessions[d.session]
  if session and session.client then return d.source == session.client and "client" or "server" end
  return d.source:match(":" .. PORT .. "$") and "server" or "client"
end

-- What is wrong with a header whose version is known. `items` are its lines in the tree, by name; `whole` the bytes that
-- were sent.
local function judge_header(d, items, whole, fault)
  local told = HEADER + d.payload + d.tag
  if d.reserved:match("[^%z]") then fault(items.reserved, "bad_reserved", "reserved bytes are not 0") end
  if d.tag ~= 0 and d.tag ~= TAG then
    fault(items.tag_length, "bad_length", ("a tag of %d bytes; 0 or 16 are allowed"):format(d.tag))
  end
  if whole ~= told then
    fault(items.payload_length, "bad_length", ("%d bytes, where the header tells of %d"):format(whole, told))
  elseif whole > LONGEST then
    fault(items.payload_length, "bad_length", ("%d bytes; %d are allowed"):format(whole, LONGEST))
  end
  if not read_message[d.type] then
    fault(items.type, "bad_type", ("type %d is reserved or unknown"):format(d.type))
  end
end

-- The fields of a header behind its magic.
local function read_header_fields(d, tvb, add)
  local items = {type = add("type", 5, 1), payload_length = add("payload_length", 6, 2), tag_length = add("tag_length", 8, 1)}
  add("key", 9, 1)
  items.reserved = add("reserved", 10, 2)
  add("session", 12, 8)
  add("sequence", 20, 8)
  d.payload, d.tag, d.key = tvb(6, 2):le_uint(), tvb(8, 1):uint(), tvb(9, 1):uint()
  d.reserved = tvb:raw(10, 2)
  d.session, d.sequence = tostring(tvb(12, 8):le_uint64()), tvb(20, 8):le_uint64():tonumber()
  d.from = sender_of(d)
  return items
end

-- The header, into the tree and as a table; its faults stop the reading, as they stop a receiver's.
local function read_header(tvb, pinfo, tree)
  local d = {faults = {}, values = {}, frame = pinfo.number, time = pinfo.abs_ts,
             source = ("%s:%d"):format(tostring(pinfo.src), pinfo.src_port),
             destination = ("%s:%d"):format(tostring(pinfo.dst), pinfo.dst_port)}
  local whole, captured = tvb:reported_len(), tvb:len()
  d.cut = captured < whole
  local header = tree:add(tvb:range(0, math.min(HEADER, captured)), "Header")
  local function add(name, at, size) return header:add_le(F[name], tvb:range(at, size)) end
  local function fault(item, kind, text)
    item:add_proto_expert_info(E[kind], text)
    table.insert(d.faults, text)
  end
  if captured < HEADER then
    fault(header, d.cut and "cut" or "bad_length", ("%d bytes; a header has %d"):format(captured, HEADER))
    return d
  end
  local magic = add("magic", 0, 4)
  if tvb:raw(0, 4) ~= "PLPT" then
    fault(magic, "bad_magic", "not Palpate: the magic is wrong")
    return d
  end
  local version = add("version", 4, 1)
  d.version, d.type = tvb(4, 1):uint(), tvb(5, 1):uint()
  if d.version ~= VERSION then
    fault(version, "bad_version", ("version %d is unknown"):format(d.version))
    return d
  end
  judge_header(d, read_header_fields(d, tvb, add), whole, fault)
  return d
end

-- The payload: its faults are added to those of the datagram.
local function read_payload(d, tvb, tree)
  local size = math.min(d.payload, tvb:len() - HEADER)
  local branch = tree:add(tvb:range(HEADER, size), TYPE_NAMES[d.type])
  local r = new_reader(size > 0 and tvb:range(HEADER, size) or nil, branch)
  read_message[d.type](r)
  if r.short then
    r:fault(branch, d.cut and "cut" or "bad_length", d.cut and "cut short by the capture"
      or ("a payload of %d bytes is too short for this type"):format(d.payload))
  elseif r:left() > 0 then
    branch:add(F.extra, tvb:range(HEADER + r.at, size - r.at))
  end
  d.values, d.faults, d.is_whole = r.values, r.faults, not r.short
end

-- What the first pass found, as fields that Wireshark marks as generated.
local function show(result, d, tree)
  local function add(name, value)
    if value ~= nil then tree:add(F[name], value):set_generated() end
  end
  add("tag_verdict", result.tag_verdict)
  if d.is_whole and d.values.f then add("force", size_of(d.values.f)) end
  add("age", result.age)
  add("round_trip", result.round_trip)
  add("answers", result.answers)
  add("gap", result.gap)
  add("page.kind", result.page_kind)
  for _, found in ipairs(result.experts) do tree:add_proto_expert_info(E[found[1]], found[2]) end
end

-- Fills the Info column: type, essentials, and in brackets what is wrong.
local function tell(pinfo, d, result)
  local text = TYPE_NAMES[d.type] or "Datagram"
  if d.is_whole then text = text .. info_of[d.type](d.values, result) end
  for _, fault in ipairs(d.faults) do text = text .. " [" .. fault .. "]" end
  for _, found in ipairs(result.experts) do text = text .. " [" .. found[2] .. "]" end
  pinfo.cols.info:set(text)
end

function palpate.dissector(tvb, pinfo, tree)
  pinfo.cols.protocol:set("Palpate")
  local root = tree:add(palpate, tvb:range())
  local d, result = read_header(tvb, pinfo, root), {experts = {}}
  if #d.faults == 0 then
    read_payload(d, tvb, root)
    local behind = HEADER + d.payload
    local has_tag = d.tag == TAG and not d.cut
    if has_tag then root:add(F.tag, tvb:range(behind, TAG)) end
    -- What an ICMP error quotes was sent before, and is no datagram of the session.
    if not pinfo.visited and not pinfo.in_error_pkt and not d.cut then
      results[pinfo.number] = examine(d, tvb:raw(0, behind), has_tag and tvb:raw(behind, TAG) or nil)
    end
    result = not pinfo.in_error_pkt and results[pinfo.number] or result
    show(result, d, root)
  end
  root:append_text((", %s"):format(TYPE_NAMES[d.type] or "not read"))
  tell(pinfo, d, result)
  return tvb:len()
end

DissectorTable.get("udp.port"):add(PORT, palpate)

-- On other ports the magic tells.
palpate:register_heuristic("udp", function(tvb, pinfo, tree)
  if tvb:len() < HEADER or tvb:raw(0, 4) ~= "PLPT" then return false end
  palpate.dissector(tvb, pinfo, tree)
  return true
end)
