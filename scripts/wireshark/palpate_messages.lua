-- How the payloads of Palpate's messages are read, into the tree and into values: step by step, as palpate_fields.lua has
-- them from the table of messages.h. For palpate.lua: gives a function of what palpate_fields.lua gives.

return function(P)
  local F, E = P.fields, P.experts

  -- What is wrong with a number that a step reads, or nothing: limits of messages.h, as palpate_table.lua has them.
  local function offence(step, x)
    if step.names then return not step.names[x] and "has no meaning" or nil end
    if not step.within then return nil end
    local least, most, is_open = step.within[1], step.within[2], step.within[3]
    if x < least or x > most or (is_open and x == least) then
      return (is_open and "is not above %.10g and up to %.10g" or "is not within %.10g to %.10g"):format(least, most)
    end
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
    local wrong = offence(step, x)
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

  -- ASCII and zeros.
  function Reader:text(step)
    local bytes = self:take(step.size)
    if not bytes then return end
    local raw = bytes:raw()
    local text = raw:match("^[^%z]*")  -- bytes:stringz() would go on behind a text that fills its field
    local item = self.tree:add(F[step.name], bytes, text)
    self.values[step.name] = text
    if raw:match("^[ -~%z]*$") == nil then
      self:fault(item, "out_of_range", step.name .. " is not ASCII")
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
    local unit = step.unit_length
    if unit and not (math.abs(square - 1) < unit.tolerance or (unit.or_zero and square == 0)) then
      self:fault(branch, "out_of_range", step.name .. " does not have length 1")
    end
  end

  -- A field of flags with its bits below; its value `name`_set has those that are set, as a list and by name.
  function Reader:flags(step)
    local value, item = self:number(step)
    if not item then return end
    local set, size = {}, NUMBERS[step.type][1]
    for _, flag in ipairs(step.flags) do
      local name, mask = flag[1], flag[2]
      item:add_le(F[step.name .. "." .. name], self.bytes:range(self.at - size, size))
      if math.floor(value / mask) % 2 == 1 then
        set[name] = true
        table.insert(set, name)
      end
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
