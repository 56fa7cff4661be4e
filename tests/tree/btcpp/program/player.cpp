// Plays trees on the real BehaviorTree.CPP and writes what happened, one JSON line a tree.
//
// Input, from standard input, for each tree:
//   tree <ticks> <step in ms> <halts: "-", or "3,7": the tree is halted after these ticks> <bytes of the XML>
//   <the XML>
// Output: {"error": "..."} if the library refuses the XML, or {"ticks": ["R a+ c?1", ...]}: the
// root's status (R, S, F or K for skipped; H for a halt; X for an exception, after which no more is
// ticked) and the events of the leaves in their order: a+ begins, a=s succeeds, a=f fails,
// a! is halted, c?1 is asked and holds.
//
// Nodes that are not built in are taken from the XML's TreeNodesModel. An action named Act and a
// condition named Given follow a script in their ports; any other leaf succeeds at once. The wake-up
// signal is switched off, so that a tick of the tree is one visit of its root.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "behaviortree_cpp/bt_factory.h"
#include "behaviortree_cpp/utils/timer_queue.h"
#include "tinyxml2.h"

namespace
{
std::vector<std::string> events;
int tick_number = 0;

std::string text(const BT::TreeNode& node, const std::string& port, const std::string& otherwise)
{
  const auto value = node.getInput<std::string>(port);
  return value && !value.value().empty() ? value.value() : otherwise;
}

char pick(const std::string& script, int index)
{
  return script[std::min<std::size_t>(index, script.size() - 1)];
}

// Runs for `ticks` ticks, then ends as the letter of `ends` says that belongs to this start.
class Act : public BT::StatefulActionNode
{
public:
  using StatefulActionNode::StatefulActionNode;

  BT::NodeStatus onStart() override
  {
    events.push_back(text(*this, "id", name()) + "+");
    left_ = std::stoi(text(*this, "ticks", "0"));
    return proceed();
  }

  BT::NodeStatus onRunning() override
  {
    return proceed();
  }

  void onHalted() override
  {
    ++starts_;
    events.push_back(text(*this, "id", name()) + "!");
  }

private:
  BT::NodeStatus proceed()
  {
    if(left_-- > 0)
    {
      return BT::NodeStatus::RUNNING;
    }
    const bool succeeds = pick(text(*this, "ends", "s"), starts_++) == 's';
    events.push_back(text(*this, "id", name()) + (succeeds ? "=s" : "=f"));
    return succeeds ? BT::NodeStatus::SUCCESS : BT::NodeStatus::FAILURE;
  }

  int left_ = 0;
  int starts_ = 0;
};

// Answers with the letter of `answers` that belongs to the present tick.
class Given : public BT::ConditionNode
{
public:
  using ConditionNode::ConditionNode;

  BT::NodeStatus tick() override
  {
    const bool holds = pick(text(*this, "answers", "1"), tick_number) == '1';
    events.push_back(text(*this, "id", name()) + (holds ? "?1" : "?0"));
    return holds ? BT::NodeStatus::SUCCESS : BT::NodeStatus::FAILURE;
  }
};

class Leaf : public BT::SyncActionNode
{
public:
  using SyncActionNode::SyncActionNode;

  BT::NodeStatus tick() override
  {
    return BT::NodeStatus::SUCCESS;
  }
};

class Check : public BT::ConditionNode
{
public:
  using ConditionNode::ConditionNode;

  BT::NodeStatus tick() override
  {
    return BT::NodeStatus::SUCCESS;
  }
};

// Hands a success of its child that took time on at the next tick, as a round of a loop ends its tick.
// With `attempts="3"` it stands in a `retry` and does so with failures, up to the second.
class Later : public BT::DecoratorNode
{
public:
  Later(const std::string& name, const BT::NodeConfig& config) : DecoratorNode(name, config)
  {}

  BT::NodeStatus tick() override
  {
    if(waits_)
    {
      waits_ = false;
      return end_;
    }
    const bool was_running = status() == BT::NodeStatus::RUNNING;
    setStatus(BT::NodeStatus::RUNNING);
    end_ = child_node_->executeTick();
    if(end_ == BT::NodeStatus::RUNNING || end_ == BT::NodeStatus::SKIPPED)
    {
      return end_;
    }
    resetChild();
    const int attempts = std::stoi(text(*this, "attempts", "0"));
    const bool is_success = end_ == BT::NodeStatus::SUCCESS;
    const bool is_last = attempts > 0 ? is_success || ++ends_ == attempts : !is_success;
    ends_ = is_last ? 0 : ends_;
    waits_ = was_running && !is_last;
    return waits_ ? BT::NodeStatus::RUNNING : end_;
  }

  void halt() override
  {
    waits_ = false;
    ends_ = 0;
    DecoratorNode::halt();
  }

private:
  bool waits_ = false;
  int ends_ = 0;
  BT::NodeStatus end_ = BT::NodeStatus::IDLE;
};

// The second child is ticked once when the first is halted, after it was.
class OnHalt : public BT::ControlNode
{
public:
  OnHalt(const std::string& name, const BT::NodeConfig& config) : ControlNode(name, config)
  {}

  BT::NodeStatus tick() override
  {
    setStatus(BT::NodeStatus::RUNNING);
    const BT::NodeStatus status = children_nodes_[0]->executeTick();
    if(status != BT::NodeStatus::RUNNING)
    {
      resetChildren();
    }
    return status;
  }

  void halt() override
  {
    if(status() == BT::NodeStatus::RUNNING)
    {
      haltChild(0);
      children_nodes_[1]->executeTick();
    }
    ControlNode::halt();
  }
};

// Decorators and controls of the mission language itself: known to the parser, and not played.
class Passing : public BT::DecoratorNode
{
public:
  Passing(const std::string& name, const BT::NodeConfig& config) : DecoratorNode(name, config)
  {}

  BT::NodeStatus tick() override
  {
    return child_node_->executeTick();
  }
};

BT::PortsList ports_of(const tinyxml2::XMLElement* model)
{
  BT::PortsList ports;
  for(auto port = model->FirstChildElement(); port != nullptr; port = port->NextSiblingElement())
  {
    const std::string tag = port->Name();
    const char* name = port->Attribute("name");
    if(name == nullptr || tag == "MetadataFields")
    {
      continue;
    }
    const auto direction = tag == "input_port" ? BT::PortDirection::INPUT :
                           tag == "output_port" ? BT::PortDirection::OUTPUT :
                                                  BT::PortDirection::INOUT;
    ports.insert({ name, BT::PortInfo(direction) });
  }
  return ports;
}

template <typename Node>
void add(BT::BehaviorTreeFactory& factory, BT::NodeType type, const std::string& id,
         BT::PortsList ports)
{
  BT::TreeNodeManifest manifest{ type, id, std::move(ports), {} };
  factory.registerBuilder(manifest, [](const std::string& name, const BT::NodeConfig& config) {
    return std::make_unique<Node>(name, config);
  });
}

void add_model(BT::BehaviorTreeFactory& factory, const std::string& tag, const std::string& id,
               const BT::PortsList& ports)
{
  using BT::NodeType;
  if(id == "Act")
    add<Act>(factory, NodeType::ACTION, id, ports);
  else if(id == "Given")
    add<Given>(factory, NodeType::CONDITION, id, ports);
  else if(id == "OnHalt")
    add<OnHalt>(factory, NodeType::CONTROL, id, ports);
  else if(id == "Later")
    add<Later>(factory, NodeType::DECORATOR, id, ports);
  else if(tag == "Action")
    add<Leaf>(factory, NodeType::ACTION, id, ports);
  else if(tag == "Condition")
    add<Check>(factory, NodeType::CONDITION, id, ports);
  else if(tag == "Control")
    add<OnHalt>(factory, NodeType::CONTROL, id, ports);
  else if(tag == "Decorator")
    add<Passing>(factory, NodeType::DECORATOR, id, ports);
}

void add_models(BT::BehaviorTreeFactory& factory, const std::string& xml)
{
  tinyxml2::XMLDocument document;
  document.Parse(xml.c_str(), xml.size());
  const auto* root = document.RootElement();
  const auto* models = root != nullptr ? root->FirstChildElement("TreeNodesModel") : nullptr;
  if(models == nullptr)
  {
    return;
  }
  for(auto model = models->FirstChildElement(); model != nullptr;
      model = model->NextSiblingElement())
  {
    const char* id = model->Attribute("ID");
    if(id != nullptr && std::string(model->Name()) != "SubTree" &&
       factory.builders().count(id) == 0)
    {
      add_model(factory, model->Name(), id, ports_of(model));
    }
  }
}

struct NoWakeUp : BT::TreeNode
{
  static void apply(BT::TreeNode* node)
  {
    (node->*(&NoWakeUp::setWakeUpInstance))(nullptr);
  }
};

std::string quoted(const std::string& words)
{
  std::string out = "\"";
  for(const char c : words)
  {
    if(c == '"' || c == '\\')
    {
      out += '\\';
    }
    out += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  return out + "\"";
}

char letter(BT::NodeStatus status)
{
  switch(status)
  {
    case BT::NodeStatus::RUNNING:
      return 'R';
    case BT::NodeStatus::SUCCESS:
      return 'S';
    case BT::NodeStatus::FAILURE:
      return 'F';
    case BT::NodeStatus::SKIPPED:
      return 'K';
    default:
      return '?';
  }
}

void tell(char status, bool is_first)
{
  std::string line(1, status);
  for(const auto& event : events)
  {
    line += " " + event;
  }
  events.clear();
  std::cout << (is_first ? "" : ", ") << quoted(line);
}

void play(BT::Tree& tree, int ticks, int step_ms, const std::set<int>& halts)
{
  tree.initialize();
  tree.applyVisitor([](BT::TreeNode* node) { NoWakeUp::apply(node); });
  std::cout << "{\"ticks\": [";
  bool is_first = true;
  for(tick_number = 0; tick_number < ticks; ++tick_number)
  {
    if(tick_number > 0)
    {
      BT::played::Time::instance().advance(step_ms);
    }
    try
    {
      const auto status = tree.tickExactlyOnce();
      tell(letter(status), is_first);
      is_first = false;
      if(status == BT::NodeStatus::SKIPPED)
      {
        break;
      }
    }
    catch(const std::exception&)
    {
      tell('X', is_first);
      break;
    }
    if(halts.count(tick_number + 1) != 0)
    {
      tree.haltTree();
      tell('H', false);
    }
  }
  std::cout << "]}" << std::endl;
}

std::set<int> numbers(const std::string& listed)
{
  std::set<int> found;
  std::stringstream stream(listed == "-" ? "" : listed);
  for(std::string number; std::getline(stream, number, ',');)
  {
    found.insert(std::stoi(number));
  }
  return found;
}
}  // namespace

int main()
{
  std::string word, halts;
  int ticks = 0;
  int step_ms = 0;
  std::size_t size = 0;
  while(std::cin >> word >> ticks >> step_ms >> halts >> size)
  {
    std::cin.ignore();
    std::string xml(size, '\0');
    std::cin.read(xml.data(), static_cast<std::streamsize>(size));
    events.clear();
    try
    {
      BT::BehaviorTreeFactory factory;
      add_models(factory, xml);
      auto tree = factory.createTreeFromText(xml);
      play(tree, ticks, step_ms, numbers(halts));
      tree.haltTree();
    }
    catch(const std::exception& error)
    {
      std::cout << "{\"error\": " << quoted(error.what()) << "}" << std::endl;
    }
  }
}
