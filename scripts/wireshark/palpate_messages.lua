-- How the payloads of Palpate's messages are read, field by field, into the tree and into values (protocol/README.md).
-- For palpate.lua: gives a function of what palpate_fields.lua gives.

return function(P)
  local HELLO, CHALLENGE, WELCOME, REFUSE, BYE, TOOL_STATE, FORCE_SAMPLE, TELEMETRY, POINTER, SURFACE_PAGE =
    table.unpack(P.types)
  local F, E, groups, flag_lists = P.fields, P.experts, P.groups, P.flag_lists

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

  -- ASCII, then zeros.
  function Reader:text(name, size)
    local bytes = self:take(size)
    if not bytes then return end
    local item = self.tree:add(F[name], bytes)
    self.values[name] = bytes:stringz()
    if bytes:raw():match("^[ -~]*%z*$") == nil then
      self:fault(item, "out_of_range", name .. " is not ASCII, then zeros")
    end
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
    r:raw("padding", P.hello_payload - 40)
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
    r:u8("reason", one_of(P.reasons))
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

  local function read_loads(r)
    for _ = 1, math.min(r:u8("loads.count", within(0, 75)), 75) do r:f32("loads.load", within(-1e6, 1e6)) end
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
        r:u8("errors." .. of .. "_source", one_of(P.sources))
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
    {"loads", read_loads},
    {"cuts", function(r) r:u32("cuts") end},
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

  read_message[TELEMETRY] = function(r)
    r:u8("tool", TOOLS)
    r:flags("telemetry", 2)
    r:i64("t")
    r:u32("dt")
    r:group("p", HUGE)
    r:group("f", HUGE)
    r:i64("sample_age")
    r:u32("period")
    r:u32("longest_period")
    r:u64("ticks")
    r:u64("missed")
    r:f32("passivity_gain", within(0, 1))
    for _, name in ipairs({"faded", "clamped", "slewed", "damped"}) do r:u32(name) end
    r:text("device", 32)
    r:text("felt_law", 32)
    r:u8("named", within(0, 7))
    r:text("law", 32)
    r:f32("law_error", within(-1e38, 1e6))
    local laws, count = r:u8("laws", within(0, 8)), r:u8("count", within(0, 24))
    if count == 0 then return end
    r:part("Force felt", function()
      for _ = 1, count do r:f32("felt", HUGE) end
    end)
    if laws == 0 then return end
    r:part("Forces by the laws", function()
      for _ = 1, count * laws do r:f32("by_law", HUGE) end
    end)
  end

  read_message[POINTER] = function(r)
    r:u8("tool", TOOLS)
    r:u64("pointer", at_least_1)
    r:group("p", HUGE)
    r:u16("buttons")
  end

  read_message[SURFACE_PAGE] = function(r)
    r:u8("tool", TOOLS)
    r:u32("page.version")
    r:u32("page", within(0, 0xfffffffe))
    r:part("Values", function()
      for _ = 1, 225 do r:f32("page.value", HUGE) end
    end)
  end

  return read_message, new_reader
end
