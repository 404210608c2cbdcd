-- How the payloads of Palpate's messages are read, into the tree and into values: step by step, as palpate_fields.lua has
-- them from the table of messages.h. For palpate.lua: gives a function of what palpate_fields.lua gives.

return function(P)
  local F, E, constants = P.fields, P.experts, P.constants

  -- Limits --------------------------------------------------------------------------------------------------------------

  -- A limit says what is wrong with a number, or nothing. They are those of `valid` in protocol/codec.cpp.
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
  local function tool_radius(x, values)
    return (values["surface.version"] == 0 and within(0, 1) or above_0_up_to(1))(x)
  end
  local function any() end

  local ANY_REAL, AMPLITUDE, MODES = within(-1e9, 1e9), within(-1e6, 1e6), within(0, constants.kMaxPublishedModes)
  local NO_PAGE, MOST_LAWS = constants["ToolState.kNoPage"], constants["Telemetry.kMostLaws"]
  local LIMITS = {  -- of real numbers that are not in this list: ANY_REAL
    tool = within(0, 7), rate = within(0, 1e6), tool_radius = above_0_up_to(1),
    tick = at_least_1, q = any, lead = within(0, 1e10),
    sample = at_least_1, ["here.normal"] = any, ["ahead.normal"] = any,
    ["here.gap"] = within(0, 1e9), ["ahead.gap"] = within(0, 1e9),
    ["surface.vertices"] = within(0, 20000), ["surface.triangles"] = within(0, 40000),
    ["surface.tool_radius"] = tool_radius, ["surface.tool_friction"] = within(0, 10),
    ["surface.tool_compliance"] = within(0, 1e6),
    ["errors.mesh"] = within(0, 1e6), ["errors.time_step"] = within(0, 1e6), ["others.compliance"] = AMPLITUDE,
    ["modes.q"] = AMPLITUDE, ["modes.v"] = AMPLITUDE, ["loads.load"] = AMPLITUDE,
    ["relaxed.share"] = within(0, 1), ["relaxed.time"] = within(0, 1e6),
    ["relaxed.first"] = MODES, ["relaxed.count"] = MODES, ["relaxed.z"] = AMPLITUDE, ["relaxed.psi"] = AMPLITUDE,
    passivity_gain = within(0, 1), named = within(0, MOST_LAWS - 1),
    law_error = within(-1e38, 1e6), laws = within(0, MOST_LAWS),
    pointer = at_least_1, page = within(0, NO_PAGE - 1),
  }
  -- Vectors of length 1; or 0, where that says something.
  local UNIT = {q = {may_be_0 = false}, ["here.normal"] = {may_be_0 = true}, ["ahead.normal"] = {may_be_0 = true}}
  -- What is added to a number in the tree.
  local NOTES = {asked_page = {[NO_PAGE] = ": none"}}

  -- What is wrong with a number that a step reads, or nothing.
  local function offence(step, x, values)
    if step.names then return not step.names[x] and "has no meaning" or nil end
    if step.at_most then return within(0, step.at_most)(x) end
    local limit = LIMITS[step.name] or (step.type:match("^f") and ANY_REAL) or any
    return limit(x, values)
  end

  -- A reader of payloads ------------------------------------------------------------------------------------------------

  -- Walks a payload step by step, as the C++ reader does: adds each field to the tree, keeps its value by its name, and
  -- its faults. Where the bytes run out a field is 0, and `short` is set.
  local Reader = {}
  Reader.__index = Reader

  local function new_reader(range_of_bytes, tree)
    return setmetatable({bytes = range_of_bytes, at = 0, tree = tree, values = {}, items = {}, faults = {}, short = false},
                        Reader)
  end

  function Reader:rest()
    return self.bytes and self.bytes:len() - self.at or 0
  end

  function Reader:take(size)
    if self.short or self:rest() < size then
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

  -- Size and getter of each type of number.
  local NUMBERS = {u8 = {1, "le_uint"}, u16 = {2, "le_uint"}, u32 = {4, "le_uint"}, u64 = {8, "le_uint64"},
                   i64 = {8, "le_int64"}, f32 = {4, "le_float"}, f64 = {8, "le_float"}}

  function Reader:number(step, part, tree)
    local name, kind = part and step.name .. "." .. part or step.name, NUMBERS[step.type]
    local bytes = self:take(kind[1])
    if not bytes then return 0 end
    local value = bytes[kind[2]](bytes)
    local item = (tree or self.tree):add_le(F[name], bytes)
    self.values[name], self.items[name] = value, item
    local x = type(value) == "number" and value or value:tonumber()
    if NOTES[name] and NOTES[name][x] then item:append_text(NOTES[name][x]) end
    local wrong = offence(step, x, self.values)
    if x ~= x or x == math.huge or x == -math.huge then
      self:fault(item, "not_finite", name .. " is not a finite number")
    elseif wrong then
      self:fault(item, "out_of_range", name .. " " .. wrong)
    end
    if step.at_most then self.values[name] = math.min(x, step.at_most) end
    return value, item
  end

  function Reader:raw(step)
    local bytes = self:take(step.size)
    if not bytes then return end
    self.tree:add(F[step.name], bytes)
    self.values[step.name] = bytes:raw()
  end

  -- ASCII, then zeros.
  function Reader:text(step)
    local bytes = self:take(step.size)
    if not bytes then return end
    local item = self.tree:add(F[step.name], bytes)
    self.values[step.name] = bytes:stringz()
    if bytes:raw():match("^[ -~]*%z*$") == nil then
      self:fault(item, "out_of_range", step.name .. " is not ASCII, then zeros")
    end
  end

  -- Several numbers below one line of the tree.
  function Reader:group(step)
    local size = NUMBERS[step.type][1] * #step.parts
    if self.short or self:rest() < size then
      self.short = true
      return
    end
    local branch = self.tree:add(self.bytes:range(self.at, size), step.label)
    local list, texts, square = {}, {}, 0
    for i, part in ipairs(step.parts) do
      list[i] = self:number(step, part, branch)
      texts[i], square = ("%.6g"):format(list[i]), square + list[i] ^ 2
    end
    branch:append_text((": (%s)%s"):format(table.concat(texts, ", "), step.unit and " " .. step.unit or ""))
    self.values[step.name] = list
    local unit = UNIT[step.name]
    if unit and not (math.abs(square - 1) < 1e-6 or (unit.may_be_0 and square == 0)) then
      self:fault(branch, "out_of_range", step.name .. " does not have length 1")
    end
  end

  -- A field of flags with its bits below; its value `name`_set has those that are set, by name.
  function Reader:flags(step)
    local value, item = self:number(step)
    if not item then return end
    local set, size = {}, NUMBERS[step.type][1]
    for _, flag in ipairs(step.flags) do
      local name, mask = flag[1], flag[2]
      item:add_le(F[step.name .. "." .. name], self.bytes:range(self.at - size, size))
      set[name] = math.floor(value / mask) % 2 == 1
    end
    self.values[step.name .. "_set"] = set
  end

  function Reader:field(step)
    if step.flags then return self:flags(step) end
    if step.parts then return self:group(step) end
    if step.type == "bytes" then return self:raw(step) end
    if step.type == "text" then return self:text(step) end
    self:number(step)
  end

  -- Calls `work` with the tree one branch deeper, if there is a label for it.
  function Reader:below(label, work)
    if not label then return work() end
    if self:rest() == 0 then
      self.short = true
      return
    end
    local outer, from = self.tree, self.at
    self.tree = outer:add(self.bytes:range(from), label)
    work()
    self.tree:set_len(self.at - from)
    self.tree = outer
  end

  -- How often a step repeats: a product, but at most as often as a receiver has room for.
  function Reader:times(step)
    local times, names, item = 1, {}, nil
    for _, factor in ipairs(step.count) do
      local value = type(factor) == "number" and factor or self.values[factor] or 0
      times, item = times * value, item or self.items[factor]
      table.insert(names, tostring(factor))
    end
    local most = step.most or math.huge
    if step.each then most = math.min(most, math.floor(step.room / (self.values[step.each] or 0))) end
    if times > most and item then
      self:fault(item, "out_of_range", ("%s is not within 0 to %.10g"):format(table.concat(names, " * "), most))
    end
    return math.min(times, most)
  end

  function Reader:walk(steps)
    for _, step in ipairs(steps) do
      local set, times = step.of and self.values[step.of .. "_set"], step.count and self:times(step) or 0
      if set and set[step.flag] then
        self:below(step.branch, function() self:walk(step.steps) end)
      elseif times > 0 then
        self:below(step.branch, function()
          for _ = 1, times do self:walk(step.steps) end
        end)
      elseif step.type then
        self:field(step)
      end
    end
  end

  -- The messages --------------------------------------------------------------------------------------------------------

  local read_message = {}  -- by type: reads the fields of a payload in their order
  for type_of_message, message in pairs(P.messages) do
    read_message[type_of_message] = function(r) r:walk(message.steps) end
  end

  local read_hello = read_message[P.types.Hello]
  read_message[P.types.Hello] = function(r)
    read_hello(r)
    r:raw({name = "padding", size = P.hello_payload - r.at})
  end

  return read_message, new_reader
end
