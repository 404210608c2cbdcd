-- Wireshark and tshark show Palpate's datagrams with this: every field of protocol/README.md, version 2, what its
-- receiver would refuse, what was seen before, how old a force is, and whether a tag is good. How to install and use it:
-- README.md beside this file. Lua 5.2 or later; the other Lua files must lie beside it.

local FOLDER = debug.getinfo(1, "S").source:match("^@?(.*[/\\])") or ""
local function part(name) return dofile(FOLDER .. name) end
local P = part("palpate_fields.lua")(part("palpate_table.lua"))
local read_message, new_reader = part("palpate_messages.lua")(P)
local sessions = part("palpate_sessions.lua")(P, part("blake2b.lua"))

local PORT = 45130
local TYPE = P.types
local F, E = P.fields, P.experts

local palpate = Proto("palpate", "Palpate")
palpate.prefs.key_file = Pref.string("Key file", "", "Text file with lines of \"palpate-key NUMBER 64-HEX-DIGITS\"")
palpate.fields, palpate.experts = P.all_fields, P.all_experts

local results = {}  -- by frame: what the first pass found; the passes after it only show that

function palpate.init()
  results = {}
  sessions.begin(palpate.prefs.key_file)
end

-- The lines of the Info column ----------------------------------------------------------------------------------------

local function in_mm(p) return ("(%.2f, %.2f, %.2f) mm"):format(p[1] * 1e3, p[2] * 1e3, p[3] * 1e3) end
local function size_of(f) return math.sqrt(f[1] ^ 2 + f[2] ^ 2 + f[3] ^ 2) end
local function hex_of(bytes) return (bytes:gsub(".", function(c) return ("%02x"):format(c:byte()) end)) end

-- The names of the flags that are set, behind a comma.
local function names_of(set)
  return (#set > 0 and ", " or "") .. table.concat(set, ",")
end

local info_of = {}  -- by type, where a line says more than the type: what matters of a message

info_of[TYPE.Hello] = function(v)
  return (" nonce %s%s"):format(hex_of(v.nonce), v.cookie == P.no_nonce and "" or ", with a cookie")
end
info_of[TYPE.Challenge] = function(v) return " nonce " .. hex_of(v.nonce) end
info_of[TYPE.Welcome] = function(v)
  return (" nonce %s, tool %d, %g Hz, radius %g mm"):format(hex_of(v.nonce), v.tool, v.rate, v.tool_radius * 1e3)
end
info_of[TYPE.Refuse] = function(v) return " " .. (P.reasons[v.reason] or "for an unknown reason") end
info_of[TYPE.ToolState] = function(v, result)
  return (" tool %d, tick %s, p %s, used sample %s%s%s"):format(
    v.tool, tostring(v.tick), in_mm(v.p), tostring(v.newest_sample),
    result.age and (", %.1f ms old"):format(result.age) or "",
    names_of(v["tool_state.flags_set"]))
end
info_of[TYPE.ForceSample] = function(v, result)
  return (" tool %d, number %s, answers tick %s%s, |f| %.3f N%s"):format(
    v.tool, tostring(v.number), tostring(v.tool_tick),
    result.round_trip and (" after %.1f ms"):format(result.round_trip) or "", size_of(v.f),
    names_of(v["force_sample.flags_set"]))
end
info_of[TYPE.Telemetry] = function(v)
  return (" tool %d, renders %.3f N by %s on %s, %d ticks"):format(v.tool, size_of(v.f), v.rendered_law, v.device, v.count)
end
info_of[TYPE.Pointer] = function(v)
  return (" tool %d, number %s, p %s"):format(v.tool, tostring(v.number), in_mm(v.p))
end
info_of[TYPE.SurfacePage] = function(v, result)
  return (" tool %d, page %d of model %d%s"):format(
    v.tool, v.page, v["surface_page.version"], result.page_kind and ": " .. result.page_kind or "")
end

-- The dissector -------------------------------------------------------------------------------------------------------

-- Who sent a datagram: the type tells, but for a Bye. That is the server's unless it comes from the client's address.
local function sender_of(d)
  local sender = P.messages[d.type] and P.messages[d.type].sender or "server"
  if sender ~= "either" then return sender end
  local client = sessions.client_of(d.session)
  if client then return d.source == client and "client" or "server" end
  return d.source:match(":" .. PORT .. "$") and "server" or "client"
end

-- What is wrong with a header whose version is known. `items` are its lines in the tree, by name; `whole` the bytes that
-- were sent.
local function judge_header(d, items, whole, fault)
  local expected = P.header + d.payload + d.tag
  if d.reserved:match("[^%z]") then fault(items.reserved, "bad_reserved", "reserved bytes are not 0") end
  if d.tag ~= 0 and d.tag ~= P.tag then
    fault(items.tag_length, "bad_length", ("a tag of %d bytes; 0 or 16 are allowed"):format(d.tag))
  end
  if whole ~= expected then
    fault(items.payload_length, "bad_length", ("%d bytes, where the header says %d"):format(whole, expected))
  elseif whole > P.longest then
    fault(items.payload_length, "bad_length", ("%d bytes; %d are allowed"):format(whole, P.longest))
  end
  if not read_message[d.type] then
    fault(items.type, "bad_type", ("type %d is reserved or unknown"):format(d.type))
  end
end

-- The fields of a header behind its magic.
local function read_header_fields(d, tvb, add)
  local items = {type = add("type", 5, 1), payload_length = add("payload_length", 6, 2),
                 tag_length = add("tag_length", 8, 1)}
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
  local header = tree:add(tvb:range(0, math.min(P.header, captured)), "Header")
  local function add(name, at, size) return header:add_le(F[name], tvb:range(at, size)) end
  local function fault(item, kind, text)
    item:add_proto_expert_info(E[kind], text)
    table.insert(d.faults, text)
  end
  if captured < P.header then
    fault(header, d.cut and "cut" or "bad_length", ("%d bytes; a header has %d"):format(captured, P.header))
    return d
  end
  local magic = add("magic", 0, 4)
  if tvb:raw(0, 4) ~= "PLPT" then
    fault(magic, "bad_magic", "not Palpate: the magic is wrong")
    return d
  end
  local version = add("version", 4, 1)
  d.version, d.type = tvb(4, 1):uint(), tvb(5, 1):uint()
  if d.version ~= P.version then
    fault(version, "bad_version", ("version %d is unknown"):format(d.version))
    return d
  end
  judge_header(d, read_header_fields(d, tvb, add), whole, fault)
  return d
end

-- The payload: its faults are added to those of the datagram.
local function read_payload(d, tvb, tree)
  local size = math.min(d.payload, tvb:len() - P.header)
  local branch = tree:add(tvb:range(P.header, size), P.type_names[d.type])
  local r = new_reader(size > 0 and tvb:range(P.header, size) or nil, branch)
  read_message[d.type](r)
  -- Servers before "scene" end their Welcome in front of it.
  local is_older = d.type == TYPE.Welcome and d.payload == 57 and r.at == 57
  r.short = r.short and not is_older
  if r.short then
    r:fault(branch, d.cut and "cut" or "bad_length", d.cut and "cut short by the capture"
      or ("a payload of %d bytes is too short for this type"):format(d.payload))
  elseif r:rest() > 0 then
    branch:add(F.extra, tvb:range(P.header + r.at, size - r.at))
  end
  d.values, d.faults, d.is_whole = r.values, r.faults, not r.short
end

-- What the first pass found, as fields that Wireshark marks as generated.
local function show(result, d, tree)
  local function add(name, value)
    if value ~= nil then tree:add(F[name], value):set_generated() end
  end
  add("tag_verdict", result.tag_verdict)
  if d.is_whole and d.type == TYPE.ForceSample and d.values.f then add("force", size_of(d.values.f)) end
  add("age", result.age)
  add("round_trip", result.round_trip)
  add("answers", result.answers)
  add("gap", result.gap)
  add("page.kind", result.page_kind)
  for _, found in ipairs(result.experts) do tree:add_proto_expert_info(E[found[1]], found[2]) end
end

-- Fills the Info column: type, essentials, and in brackets what is wrong.
local function tell(pinfo, d, result)
  local text = P.type_names[d.type] or "Datagram"
  if d.is_whole and info_of[d.type] then text = text .. info_of[d.type](d.values, result) end
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
    local behind = P.header + d.payload
    local has_tag = d.tag == P.tag and not d.cut
    if has_tag then root:add(F.tag, tvb:range(behind, P.tag)) end
    -- What an ICMP error quotes was sent before, and is no datagram of the session.
    if not pinfo.visited and not pinfo.in_error_pkt and not d.cut then
      results[pinfo.number] = sessions.examine(d, tvb:raw(0, behind), has_tag and tvb:raw(behind, P.tag) or nil)
    end
    result = not pinfo.in_error_pkt and results[pinfo.number] or result
    show(result, d, root)
  end
  root:append_text((", %s"):format(P.type_names[d.type] or "not read"))
  tell(pinfo, d, result)
  return tvb:len()
end

DissectorTable.get("udp.port"):add(PORT, palpate)

-- On other ports the magic tells.
palpate:register_heuristic("udp", function(tvb, pinfo, tree)
  if tvb:len() < P.header or tvb:raw(0, 4) ~= "PLPT" then return false end
  palpate.dissector(tvb, pinfo, tree)
  return true
end)
